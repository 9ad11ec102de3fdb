// The skin as a thin elastic shell over the tissue: it resists bending. Without it, soft tissue under strong
// compression (the inside of a bent elbow) wrinkles at the size of the mesh's edges, whatever that is.
#pragma once

#include <vector>

#include "runtime/core/transform.h"
#include "trainer/simulate/materials.h"
#include "trainer/simulate/metric.h"

namespace bodyopt::trainer {

// Energy k/2 sum over skin vertices of |(L x)_i - R_i (L X)_i|^2 / A_i, zero at rest and under rigid motion. L is the
// skin's cotangent Laplacian at rest, A its lumped areas, X rest, x posed positions, and R_i a rotation given with the
// pose. This is the quadratic bending of Bergou et al. 2006 around a curved rest shape that turns with the joints.
class SkinBending {
 public:
  // `node_count` >= vertices; the skin's vertices are the first nodes.
  SkinBending(const Positions& vertices, const Triangles& triangles, Eigen::Index node_count,
              const Materials& materials = {});

  // R_i (L X)_i of a pose, V x 3, metres. rotation: at least V, rest to posed.
  Positions curvature(const std::vector<Quat>& rotation) const;
  // Adds the gradient at `nodes` (N x 3); returns the energy, joules.
  double add_gradient(const Positions& curvature, const Positions& nodes, Positions& gradient) const;

  const SparseMatrix& stiffness() const { return stiffness_; }  // k L^T A^-1 L, N x N, N/m: the constant Hessian

 private:
  Eigen::SparseMatrix<double, Eigen::RowMajor> laplacian_;  // symmetric
  Eigen::VectorXd weight_;                                  // k / A
  Positions rest_curvature_;
  SparseMatrix stiffness_;
};

}  // namespace bodyopt::trainer
