// How deep a skin that a cage carries lies in itself.
#pragma once

#include <vector>

#include "trainer/dataset/character.h"
#include "trainer/tets/cage.h"
#include "trainer/tets/skin_depth.h"
#include "trainer/tets/voxels.h"

namespace bodyopt {

// Every vertex of the skin that lies in a tet which is not its own stands for a point of the body at rest; it is as
// deep in the skin as that point is below it. Points as near at rest as one and a half edges of the skin are the same
// part and not looked at.
class CarriedDepth {
 public:
  // character and cage must outlive it.
  CarriedDepth(const Character& character, const Cage& cage);

  // Metres; 0 where no skin lies in skin. nodes: the cage's, N x 3, posed.
  double deepest(const Positions& nodes) const;

 private:
  double depth_beyond(double least, const Eigen::Vector3d& point) const;

  Tets tets_;
  Positions rest_nodes_, rest_skin_;
  Triangles triangles_;
  std::vector<EmbeddedPoint> skin_;
  std::vector<int> vertices_;  // 0 .. V - 1
  Eigen::VectorXd same_part_;  // V, metres
  double cell_;                // of the grid that finds vertices, metres
  SkinDepth depth_;            // of the skin at rest
  VoxelGrid grid_;             // around it
  std::vector<Voxel> voxels_;
};

}  // namespace bodyopt
