// Of the numbers in a picture.
#pragma once

#include "draw/png.h"

namespace bodyopt::testing {

// The dots (of 3 x 3 white pixels) of the digits between two columns.
inline std::size_t white_dots(const draw::Image& image, std::size_t begin, std::size_t end) {
  std::size_t pixels = 0;
  for (std::size_t y = 0; y < image.height; ++y) {
    for (std::size_t x = begin; x < end; ++x) pixels += image.rgba[4 * (y * image.width + x)] == 255 ? 1 : 0;
  }
  return pixels / 9;
}

}  // namespace bodyopt::testing
