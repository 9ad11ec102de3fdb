// The shape of one frame, fetched when it is needed.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "geometry/mesh.h"

namespace bodyopt {

struct Character;
class ShapeReader;
class ShapeStack;

// A cache and the character whose skin it shows. Shapes may be read on several threads.
struct ShapeCache {
  std::shared_ptr<const ShapeReader> reader;
  std::shared_ptr<const Character> character;
};

// Welded vertices, of a skin whose others are left out.
using VertexRows = std::vector<std::uint32_t>;

// In memory, a sample of a cache, or a frame of a dataset through its modifiers; of the whole skin or of some of its
// vertices.
class SampleShape {
 public:
  SampleShape() = default;
  SampleShape(Positions positions) : positions_(std::make_shared<const Positions>(std::move(positions))) {}
  SampleShape(std::shared_ptr<const ShapeCache> cache, std::uint32_t sample)
      : cache_(std::move(cache)), sample_(sample) {}
  SampleShape(std::shared_ptr<const ShapeStack> stack, std::size_t frame) : stack_(std::move(stack)), frame_(frame) {}

  // The same shape at some of the vertices, in that order.
  SampleShape at(std::shared_ptr<const VertexRows> rows) const;

  // Welded, V x 3, posed, metres. Throws Error(file) at a damaged sample.
  Positions read() const;

 private:
  Positions whole() const;

  std::shared_ptr<const Positions> positions_;
  std::shared_ptr<const ShapeCache> cache_;
  std::shared_ptr<const ShapeStack> stack_;
  std::shared_ptr<const VertexRows> rows_;  // none: the whole skin
  std::uint32_t sample_ = 0;
  std::size_t frame_ = 0;
};

}  // namespace bodyopt
