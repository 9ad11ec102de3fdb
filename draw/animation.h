// Pictures in time: animated WebP, which browsers play by themselves.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "draw/png.h"

namespace bodyopt::draw {

// Encodes frames of one size as an endless WebP animation, `milliseconds` each (on average, where that is no whole
// number). Pictures are opaque and slightly lossy; frames that look alike become one that lasts longer. Each is encoded
// as it is added, and only the result is kept. Throws Error(usage) for frames that are empty, differ in size, exceed
// WebP's size or last less than a millisecond. Throws Error(file) where encoding fails.
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

// Encodes all frames at once; throws as AnimationEncoder.
std::vector<std::uint8_t> encode_animation(std::span<const Image> frames, double milliseconds);

}  // namespace bodyopt::draw
