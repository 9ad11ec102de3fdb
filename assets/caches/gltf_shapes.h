// Shapes of a clip as glTF: one mesh with its surface, a morph target for each frame after the first. An animation
// goes from one to the next. A bound skin has its joints, their motion, and a target for every frame.
// Metres, Y up.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "assets/caches/cache_writer.h"

namespace bodyopt {

// A character is a .glb, too: what stands there under the name of a result is written over only where it is a result.
// Throws Error(usage).
void require_replaceable_shapes(const std::filesystem::path& path);

// Holds all frames in memory until close(). Normals are of the shapes, smooth over vertices that lie on one another in
// the first: seams.
class GltfShapesWriter final : public CacheWriter {
 public:
  // Throws Error(usage) where a .glb, which holds 4 GiB at most, has no room for so many frames. Throws as
  // require_replaceable_shapes(), too.
  GltfShapesWriter(const std::filesystem::path& path, CacheLayout layout);

  void append(std::span<const float> positions, std::span<const float> normals) override;
  void close() override;
  std::vector<std::filesystem::path> put_aside(const std::filesystem::path& stem) override;
  void take_up(const std::filesystem::path& stem, std::size_t frames) override;

 private:
  std::span<const float> frame(std::size_t k) const;
  Json shapes(GlbWriter& glb) const;
  Json bound_shapes(GlbWriter& glb) const;

  std::filesystem::path path_;
  CacheLayout layout_;
  std::vector<std::uint32_t> corners_;
  SplitSurface split_;
  std::vector<float> positions_;  // frames x points x 3
};

}  // namespace bodyopt
