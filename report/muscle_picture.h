// A picture of a character's muscles in its rest pose.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "draw/renderer.h"
#include "runtime/core/transform.h"

namespace bodyopt {

struct MuscleTube {
  std::vector<Vec3> path;  // metres, two points or more
  double radius;           // of the belly
};

// Seen from the front (+z), from behind and from the left: muscles as tubes with the shape of
// their bellies, in front of the half of the skin (V x 3, T x 3) that faces away. Throws what Renderer::draw throws.
Image muscle_picture(Renderer& renderer, std::span<const float> skin, std::span<const std::uint32_t> triangles,
                     std::span<const MuscleTube> muscles, std::uint32_t panel_width, std::uint32_t panel_height);

}  // namespace bodyopt
