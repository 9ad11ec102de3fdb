// How deep a point of the body lies below the skin at rest.
#pragma once

#include "geometry/nearest_skin.h"
#include "trainer/tets/voxels.h"

namespace bodyopt::trainer {

struct Depth {
  double depth;             // metres; below 0 outside
  Eigen::Vector3d inwards;  // its gradient, of length 1
};

// The signed distance to a skin of any kind: open, with holes, its faces flipped. Inside is what voxelise says, by the
// skin's normals where its cubes hold skin.
class RestDepth {
 public:
  // skin: V x 3, metres.
  RestDepth(const Positions& skin, const Triangles& triangles);
  RestDepth(const RestDepth&) = delete;  // nearest_ refers to the others
  RestDepth& operator=(const RestDepth&) = delete;

  Depth operator()(const Eigen::Vector3d& point) const;

 private:
  Positions skin_;
  Triangles triangles_;
  Positions outwards_;  // V x 3: the skin's normals
  NearestSkin nearest_;
  VoxelGrid grid_;  // around the skin
  std::vector<Voxel> voxels_;
};

}  // namespace bodyopt::trainer
