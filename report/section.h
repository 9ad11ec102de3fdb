// A body cut open: what lies behind a plane, closed by a face through its tetrahedra.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/core/transform.h"

namespace bodyopt {

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

// Where the plane passes through tets (nodes N x 3, tets T x 4): a triangle or two for each, in its colour.
Soup cut_face(std::span<const double> nodes, std::span<const int> tets, std::span<const std::array<float, 3>> colours,
              const CutPlane& plane);

}  // namespace bodyopt
