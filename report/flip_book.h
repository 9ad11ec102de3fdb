// A motion twice, frame by frame: the quasi-static skin and the same skin jiggling.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "draw/renderer.h"

namespace bodyopt {

struct FlipBook {
  std::span<const std::uint32_t> triangles;             // T x 3
  std::span<const std::vector<float>> still, jiggling;  // per frame V x 3, world, metres
};

// How each skin is drawn; width and height in pixels.
struct Panel {
  Camera camera;
  std::uint32_t width, height;
};

// A picture per frame: still on the left, jiggling on the right. Throws what Renderer::draw throws.
std::vector<Image> flip_book_frames(Renderer& renderer, const FlipBook& book, const Panel& panel);

// Chosen frames from left to right: still above, jiggling below, coloured by its distance from the still one,
// heat_colour() from 0 to scale_mm (> 0). Throws as above.
Image flip_book_strip(Renderer& renderer, const FlipBook& book, std::span<const std::size_t> frames, double scale_mm,
                      const Panel& panel);

}  // namespace bodyopt
