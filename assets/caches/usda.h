// USD as text (.usda): one mesh whose points, and normals where there are any, have a time sample per frame. Metres, Y
// up, one line per sample, so that caches of two parts of a shot can be joined line by line (join_caches.h).
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "assets/caches/cache_writer.h"
#include "assets/caches/usda_materials.h"
#include "runtime/core/atomic_file.h"

namespace bodyopt {

// How a file begins whose prim this is.
std::string usda_head(const std::string& prim, int first_frame, int last_frame, const std::string& fps);
// The parts of a mesh beside its points: triangles, texture coordinates, colours and materials. `prim`: its path.
std::string usda_mesh(const CacheLayout& layout, const std::string& prim);
// "[(x, y, z), ...]" of finite numbers, printed by all threads.
std::string usda_points(std::span<const float> values);

// "[a, b, c]", as `print` prints each.
template <class Items, class Print>
std::string usda_list(const Items& items, const Print& print) {
  std::string text = "[";
  for (const auto& item : items) text += (text.size() > 1 ? std::string(", ") : "") + print(item);
  return text + "]";
}

// Numbers are the shortest text that reads back to the same float. Images of the surface's base colours come to lie
// beside the file. Memory does not grow with the frames: normals wait in a file of their own until the points are
// complete.
class UsdaWriter final : public CacheWriter {
 public:
  UsdaWriter(const std::filesystem::path& path, CacheLayout layout);

  void append(std::span<const float> positions, std::span<const float> normals) override;
  void close() override;
  std::vector<std::filesystem::path> put_aside(const std::filesystem::path& stem) override;
  void take_up(const std::filesystem::path& stem, std::size_t frames) override;

 private:
  void write_sample(AtomicFile& file, std::span<const float> values) const;

  std::filesystem::path path_;
  CacheLayout layout_;
  AtomicFile points_, normals_;
  std::size_t written_ = 0;
  bool has_normals_ = false;
};

// In a .usda of ours samples follow either of these lines, one a line, up to a line kUsdaSamplesEnd. The line that
// names the last frame begins with kUsdaLastFrame.
inline constexpr char kUsdaPointSamples[] = "    point3f[] points.timeSamples = {";
inline constexpr char kUsdaNormalSamples[] = "    normal3f[] normals.timeSamples = {";
inline constexpr char kUsdaSamplesEnd[] = "    }";
inline constexpr char kUsdaLastFrame[] = "    endTimeCode = ";

}  // namespace bodyopt
