// A body cut open: what of its surface lies behind a plane, and the picture that closes it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/core/transform.h"

namespace bodyopt::draw {

struct CutPlane {
  Vec3 point, normal;  // what lies on the side of the unit normal is taken away
};

// Triangles with their own corners, three in a row; normals and colours (linear RGB) per corner.
struct Soup {
  std::vector<float> positions, normals, colours;
  std::vector<std::uint32_t> triangles;
};

// The part of a surface (V x 3, T x 3) behind the plane. Smooth normals, V x 3; all of one colour.
Soup cut_surface(std::span<const float> positions, std::span<const float> normals,
                 std::span<const std::uint32_t> triangles, const std::array<float, 3>& colour, const CutPlane& plane);

// A picture that stands in space.
struct StandingPicture {
  Vec3 corner, right, down;            // of the pixels, top left, metres; one pixel on, metres
  std::uint32_t width = 0;             // pixels
  std::span<const std::uint8_t> rgba;  // height x width x 4, sRGB
};
// Rectangles of the pixels of one colour that stand side by side; none of those whose alpha is 0.
Soup standing_picture(const StandingPicture& picture);

}  // namespace bodyopt::draw
