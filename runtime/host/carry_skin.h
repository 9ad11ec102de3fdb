// The full skin from a level's: what a proxy shows, in the topology of the full character.
#pragma once

#include <span>
#include <vector>

#include "runtime/basis/levels.h"
#include "runtime/core/executor.h"

namespace bodyopt {

// The position of a point of a triangle, and its frame. The axes are the interpolated normal, the triangle's first edge
// at right angles to it, and normal x edge. Unit vectors; zero where the triangle has no extent.
struct CarryFrame {
  float position[3], normal[3], edge[3], across[3];
};

// `positions`, `normals`: O x 3 of one frame, the mesh's output vertices.
CarryFrame carry_frame(const MeshTable& mesh, std::span<const float> positions, std::span<const float> normals,
                       const CarriedPoint& point);

// Returns every output vertex of the full character: F x P x 3, metres, posed. `mesh` and `carried` are those of a
// level (Level::carried). `positions`, `normals`: F x O x 3 of its output vertices, as an Evaluation has them. At rest
// and under rigid motion it is exact to half a step along each axis of the frame. full:
// memory that is used again.
std::vector<float> carry_skin(const MeshTable& mesh, const CarriedSkin& carried, std::span<const float> positions,
                              std::span<const float> normals, Executor& threads = calling_thread(),
                              std::vector<float> full = {});

}  // namespace bodyopt
