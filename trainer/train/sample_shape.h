// The shape of one frame, fetched when it is needed.
#pragma once

#include <memory>

#include "trainer/dataset/character.h"
#include "trainer/dataset/shape_reader.h"

namespace bodyopt {

// A cache and the character whose skin it shows. Shapes may be read on several threads.
struct ShapeCache {
  ShapeReader reader;
  std::shared_ptr<const Character> character;
};

// In memory, or a sample of a cache.
class SampleShape {
 public:
  SampleShape() = default;
  SampleShape(Positions positions) : positions_(std::move(positions)) {}
  SampleShape(std::shared_ptr<const ShapeCache> cache, std::uint32_t sample)
      : cache_(std::move(cache)), sample_(sample) {}

  // Welded, V x 3, posed, metres. Throws Error(file) at a damaged sample.
  Positions read() const {
    if (!cache_) return positions_;
    return welded_from_output(*cache_->character, cache_->reader.sample(sample_).data());
  }

 private:
  Positions positions_;
  std::shared_ptr<const ShapeCache> cache_;
  std::uint32_t sample_ = 0;
};

}  // namespace bodyopt
