// Where a solid of cubes is cut because skin of parts that the joints move apart touches.
#pragma once

#include "geometry/nearest_skin.h"
#include "trainer/tets/apart_skin.h"
#include "trainer/tets/voxels.h"

namespace bodyopt {

class CubeCuts {
 public:
  // The skin: rest, metres; weights: V. The arrays must outlive this.
  CubeCuts(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights);

  // For every cube of the grid by index a bit for each axis (1: x, 2: y, 4: z): the cube and the next along that axis
  // are both filled, one of them holds skin, and the skin nearest to one and to the other is of parts that the joints
  // move apart (ApartSkin). What would fall off is held by what it touches most: a body stays one, an eye in its
  // socket.
  std::vector<std::uint8_t> in(const VoxelGrid& grid, const std::vector<Voxel>& voxels) const;

 private:
  const SkinWeights& weights_;
  NearestSkin nearest_;
  ApartSkin apart_;
};

}  // namespace bodyopt
