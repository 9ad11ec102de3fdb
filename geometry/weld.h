// Welding of seam duplicates: exporters repeat a vertex wherever its texture coordinates or normals split.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "runtime/core/transform.h"

namespace bodyopt {

struct Weld {
  std::vector<std::uint32_t> welded_of;  // welded vertex of each vertex, numbered by first appearance
  std::vector<std::uint32_t> first;      // the vertex each welded vertex stands for
};

// Vertices whose coordinates differ by at most `tolerance` and whose weights (ascending by joint) differ by at most
// 1e-4 become one. Nothing when thousands of different vertices lie within `tolerance`: no skin is like that, and
// comparing them all would take forever.
[[nodiscard]] std::optional<Weld> weld_vertices(std::span<const Vec3> positions,
                                                std::span<const std::vector<JointWeight>> weights, double tolerance);

}  // namespace bodyopt
