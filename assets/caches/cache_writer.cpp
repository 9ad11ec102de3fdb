#include "assets/caches/cache_writer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "assets/caches/gltf_shapes.h"
#include "assets/caches/usda.h"
#include "assets/caches/usda_bound.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

class Pc2Cache final : public CacheWriter {
 public:
  Pc2Cache(const fs::path& path, const CacheLayout& layout)
      : writer_(path, layout.points, static_cast<std::uint32_t>(layout.frames.size()),
                layout.frames.empty() ? 1.0f : static_cast<float>(layout.frames.front()), frame_spacing(layout.frames),
                layout.space, layout.fps) {}

  void append(std::span<const float> positions, std::span<const float>) override { writer_.append(positions); }
  void close() override { writer_.close(); }
  std::vector<fs::path> put_aside(const fs::path& stem) override {
    writer_.put_aside(points_aside(stem));
    return {points_aside(stem)};
  }
  void take_up(const fs::path& stem, std::size_t frames) override {
    writer_.take_up(points_aside(stem), static_cast<std::uint32_t>(frames));
  }

 private:
  Pc2Writer writer_;
};

}  // namespace

void require_sample(const fs::path& path, const CacheLayout& layout, std::size_t done, std::span<const float> values) {
  if (values.size() != 3 * std::size_t{layout.points} || done == layout.frames.size()) {
    throw Error(ErrorKind::mismatch, path, ": a sample of ", values.size() / 3, " points was given after ", done,
                " frames to one of ", layout.points, " points and ", layout.frames.size(), " frames");
  }
  const auto bad = std::ranges::find_if_not(values, [](float value) { return std::isfinite(value); });
  if (bad == values.end()) return;
  throw Error(ErrorKind::file, path, ": frame ", layout.frames[done], ", point ", (bad - values.begin()) / 3,
              " is not a finite number: did a simulation, or what it began from, blow up?");
}

void require_all_samples(const fs::path& path, const CacheLayout& layout, std::size_t done) {
  if (done == layout.frames.size()) return;
  throw Error(ErrorKind::file, path, ": ", done, " of ", layout.frames.size(),
              " frames were given; nothing is written");
}

fs::path points_aside(const fs::path& stem) { return fs::path(stem) += ".points"; }

std::unique_ptr<CacheWriter> write_cache(const fs::path& path, CacheLayout layout) {
  if (path.extension() == ".glb") return std::make_unique<GltfShapesWriter>(path, std::move(layout));
  if (path.extension() == ".usda" && layout.bound != nullptr) {
    return std::make_unique<UsdaBoundWriter>(path, std::move(layout));
  }
  if (path.extension() == ".usda") return std::make_unique<UsdaWriter>(path, std::move(layout));
  return std::make_unique<Pc2Cache>(path, layout);
}

void require_replaceable_cache(const fs::path& path) {
  if (path.extension() == ".glb") require_replaceable_shapes(path);
}

bool holds_triangles(const fs::path& path) { return path.extension() == ".usda" || path.extension() == ".glb"; }

bool holds_normals(const fs::path& path) { return path.extension() == ".usda"; }

}  // namespace bodyopt
