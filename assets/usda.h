// USD as text (.usda): one mesh whose points, and normals where there are any, have a time sample per frame. Metres, Y
// up, one line per sample, so that caches of two parts of a shot can be joined line by line (join_caches.h).
#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "assets/bound_skin.h"
#include "assets/cache_writer.h"
#include "assets/clip.h"
#include "assets/skin_surface.h"
#include "runtime/core/atomic_file.h"

namespace bodyopt {

// The materials of a surface as USD text: a UsdPreviewSurface each, below the mesh, with images beside the file.

// Turns any text into a valid name of a prim.
std::string prim_name(const std::string& name);

// Returns text for the prim of the mesh of that name, whose path is `prim`; empty if the surface has no materials.
std::string usd_materials(const SkinSurface& surface, const std::string& mesh, const std::string& prim);

// Writes the images that the text names into the folder. Throws Error(file).
void write_usd_images(const SkinSurface& surface, const std::string& mesh, const std::filesystem::path& folder);
// Copies images that the text of a file in one folder names into another. Throws Error(file).
void copy_usd_images(const std::string& text, const std::filesystem::path& from, const std::filesystem::path& to);

// A skeleton and its motion as USD text: a Skeleton with its SkelAnimation below a SkelRoot, metres, Y up.

// Returns the skeleton and its motion, for a SkelRoot of that name; the SkelAnimation is still open. Throws Error(file)
// for numbers that are not finite; messages call the file `path`.
std::string usd_skeleton(const Clip& clip, const Skeleton& skeleton, const std::string& root,
                         const std::filesystem::path& path);

// The clip has frames, each with the joints of the skeleton. Throws Error(file).
void write_usd_skeleton(const Clip& clip, const Skeleton& skeleton, const std::filesystem::path& path);

// How a file begins whose prim this is.
std::string usda_head(const std::string& prim, int first_frame, int last_frame, const std::string& fps);
void write_text(AtomicFile& file, const std::string& text);
// The shortest that reads back to the same number.
std::string usda_number(double value);
// The parts of a mesh beside its points: triangles, texture coordinates, colours and materials. `prim`: its path.
std::string usda_mesh(const CacheLayout& layout, const std::string& prim);
// "[(x, y, z), ...]" of finite numbers, printed by all threads.
std::string usda_points(std::span<const float> values);

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

// A skin bound to its joints as USD text (UsdSkel). A SkelRoot has a Skeleton, its SkelAnimation and a Mesh with a
// BlendShape for every frame. Metres, Y up.

class UsdaBoundWriter final : public CacheWriter {
 public:
  // Throws Error(file) for a motion that is not finite.
  UsdaBoundWriter(const std::filesystem::path& path, CacheLayout layout);

  void append(std::span<const float> positions, std::span<const float> normals) override;
  void close() override;
  std::vector<std::filesystem::path> put_aside(const std::filesystem::path& stem) override;
  void take_up(const std::filesystem::path& stem, std::size_t frames) override;

 private:
  void write_shape_weights();
  std::string bound_mesh(const std::string& root) const;

  std::filesystem::path path_;
  CacheLayout layout_;
  BoundSkin bound_;  // whose joints are scaled by what a half, as USD has it, can hold
  AtomicFile file_;
  std::size_t written_ = 0;
};

// A .usda that UsdaWriter wrote, read line by line.

class UsdaPart {
 public:
  // Throws Error(file) for what UsdaWriter has not written, or what is cut off.
  explicit UsdaPart(const std::filesystem::path& path);

  // Every line of the samples that stand after `opening` (kUsdaPointSamples or kUsdaNormalSamples), in order. Throws
  // Error(file).
  void for_samples(const std::string& opening, const std::function<void(const std::string&)>& take);

  const std::filesystem::path& path() const { return path_; }
  const std::string& head() const { return head_; }  // but for the range of frames
  // The text up to the samples, with another last frame.
  std::string opening(const std::string& last_frame) const;
  const std::string& last_frame() const { return last_frame_; }
  const std::vector<int>& frames() const { return frames_; }
  // The points of frames()[sample], V x 3, metres. Throws Error(file) for numbers that are none or not finite.
  std::vector<float> points(std::size_t sample);
  // The text between the samples of points and of normals; without normals, the end of the file.
  const std::string& between() const { return between_; }
  bool has_normals() const { return has_normals_; }

 private:
  bool next() { return static_cast<bool>(std::getline(file_, line_)); }
  [[noreturn]] void refuse() const;
  void find_frames();

  std::filesystem::path path_;
  std::ifstream file_;
  std::string line_, head_, before_, after_, last_frame_, between_;
  std::streampos samples_begin_;
  std::vector<int> frames_;
  bool has_normals_ = false;
};

}  // namespace bodyopt
