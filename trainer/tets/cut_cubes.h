// Where a solid of cubes is cut because skin of parts that the joints move apart touches.
#pragma once

#include "trainer/tets/voxels.h"

namespace bodyopt {

// For every cube of the grid by index a bit for each axis (1: x, 2: y, 4: z): the cube and the next along that axis are
// both filled, one of them holds skin, and the skin nearest to one and to the other is of parts that the joints move
// apart (ApartSkin). Where the cubes would not hold together without, they are not cut: a body stays one, and what
// hangs on others by a touch alone (an eye in its socket) is held by it. `weights`: V, of the skin.
std::vector<std::uint8_t> cut_cubes(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                                    const VoxelGrid& grid, const std::vector<Voxel>& voxels);

}  // namespace bodyopt
