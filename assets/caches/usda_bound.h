// A skin bound to its joints as USD text (UsdSkel). A SkelRoot has a Skeleton, its SkelAnimation and a Mesh with a
// BlendShape for every frame. Metres, Y up.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "assets/caches/bound_skin.h"
#include "assets/caches/cache_writer.h"
#include "runtime/core/atomic_file.h"

namespace bodyopt {

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

}  // namespace bodyopt
