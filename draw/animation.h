// Pictures in time: animated WebP, which browsers play by themselves.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "draw/png.h"

namespace bodyopt {

// Frames of one size, shown so many milliseconds each (on average, where that is no whole number), over and over.
// Opaque and slightly lossy; frames that look alike become one that lasts longer. Each is encoded as it is added: kept
// is what it is encoded to. Throws Error(usage) for frames that are none, differ in size, are larger than WebP allows
// or last less than a millisecond, Error(file) when they cannot be encoded.
class AnimationEncoder {
 public:
  explicit AnimationEncoder(double milliseconds);
  ~AnimationEncoder();
  void add(const Image& frame);
  std::vector<std::uint8_t> finish();  // the file; nothing can be added after

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// All at once; throws as that.
std::vector<std::uint8_t> encode_animation(std::span<const Image> frames, double milliseconds);

}  // namespace bodyopt
