// Where a solid of cubes is cut because skin of parts that the joints move apart touches.
#pragma once

#include "trainer/tets/voxels.h"

namespace bodyopt {

// For every cube of the grid by index a bit for each axis (1: x, 2: y, 4: z): the cube and the next along that axis are
// both filled, one of them holds skin, and the skin nearest to one and to the other is of parts that the joints move
// apart (ApartSkin). What would fall off is held by what it touches most: a body stays one, an eye in its socket.
// `weights`: V, of the skin.
std::vector<std::uint8_t> cut_cubes(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                                    const VoxelGrid& grid, const std::vector<Voxel>& voxels);

}  // namespace bodyopt
