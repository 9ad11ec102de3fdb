// The points where the energy of tetrahedra of second order is summed.
#pragma once

#include <vector>

#include "geometry/tet_mesh.h"
#include "trainer/simulate/materials.h"

namespace bodyopt::trainer {

// A tet of a muscle: where its fibres run, and whose activation drives them.
struct FibreTet {
  int tet;
  int muscle;
  Eigen::Vector3d direction;  // unit, rest space
  double share = 1;           // of the tet's volume that is this muscle
};

// Four points of each tet of second order (second_order.h), with equal shares of its volume. To each belongs a linear
// tet of that volume with the deformation gradient of the point. Its corners are sums of shape functions' derivatives
// along the barycentric weights w: corner a = scale sum over nodes of x_node dN_node / dw_a. The derivative along w_a -
// w_0 is an edge of the tet, at rest as well.
class QuadraturePoints {
 public:
  QuadraturePoints() = default;
  explicit QuadraturePoints(const TetMesh& eighths);

  bool empty() const { return nodes_.rows() == 0; }
  // The linear tets at nodes (N x 3): four corners each, tet by tet.
  Positions corners(const Positions& nodes) const;
  // Adds to the gradient of the nodes what belongs to a gradient of the corners.
  void add_gradient(const Positions& of_corners, Positions& gradient) const;
  TetMesh tets(const TetMesh& eighths) const;

  // A point's part of what is known of eighths: those nearest to it have half of it, those in the middle the rest.
  static std::vector<TetMaterial> of_points(const std::vector<TetMaterial>& eighths);
  static std::vector<FibreTet> of_points(const std::vector<FibreTet>& eighths);

 private:
  Tets nodes_;  // 4 T: of corner a of a tet, itself and the middles of its edges to the others, as of its eighth
};

}  // namespace bodyopt::trainer
