// How deep a skin that a cage carries lies in itself.
#pragma once

#include <vector>

#include "assets/character.h"
#include "geometry/nearest_skin.h"
#include "trainer/tets/cage.h"
#include "trainer/tets/voxels.h"

namespace bodyopt {

// Every vertex of the skin that lies in a tet which is not its own stands for a point of the body at rest; it is as
// deep in the skin as that point is below it. In a lattice only where that tet's own part has tissue: cells overlap.
// Points as near at rest as one and a half edges of the skin are the same part and not looked at; neither is skin in
// skin that lies outside its own coarser skin.
class CarriedDepth {
 public:
  CarriedDepth(const Character& character, const Cage& cage);
  CarriedDepth(const CarriedDepth&) = delete;  // nearest_ refers to the others
  CarriedDepth& operator=(const CarriedDepth&) = delete;

  // Metres; 0 where no skin lies in skin. nodes: the cage's, N x 3, posed.
  double deepest(const Positions& nodes) const;

 private:
  bool is_tissue(Eigen::Index tet, const Eigen::Vector3d& point) const;
  double depth(const Eigen::Vector3d& point) const;

  Tets tets_;
  Positions rest_nodes_, rest_skin_;
  Triangles triangles_;
  std::vector<EmbeddedPoint> skin_;
  std::vector<int> vertices_;  // 0 .. V - 1
  Eigen::VectorXd same_part_;  // V, metres
  double cell_;                // of the grid that finds vertices, metres
  NearestSkin nearest_;        // of the skin at rest
  Positions outwards_;         // V x 3: its normals
  VoxelGrid grid_;             // around it
  std::vector<Voxel> voxels_;
  std::vector<std::vector<Eigen::Vector3d>> tissue_;  // of a lattice, per tet: its samples at rest
  double sample_reach_ = 0;                           // metres around a sample that it stands for
};

}  // namespace bodyopt
