// The elastic energy of a tet mesh with muscles and bone springs, its gradient, and a metric to solve in.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "trainer/simulate/tissue.h"

namespace bodyopt {

// What changes from pose to pose: how active each muscle is, and where bones pull.
struct Drive {
  std::vector<double> activation;        // per muscle, 0 .. 1
  std::vector<Eigen::Vector3d> targets;  // per attachment, posed, metres
};

struct ElasticForces {
  double energy = 0;        // J; infinite when a tet has no positive volume
  double element_norm = 0;  // N: root of the summed squares of every element's nodal forces
  int inverted = 0;         // tets without positive volume
};

// Energy per unit of rest volume, with F the deformation gradient, J its determinant, s the stretch |F a| along the
// fibre a:
//   mu/2 (|F|^2 - 3) + lambda/2 (J - 1 - mu/lambda)^2            stable neo-Hookean, stress-free at rest (Smith 2018)
//   + kappa (J - J0)^2 (-ln(J / J0))           for J < J0        barrier: a tet cannot invert
//   + activation k_a/2 (s - s0)^2              for s > s0        an active fibre pulls until it is contracted
//   + k_p/2 (s - 1)^2                          for s > 1         a passive fibre resists stretch
// and k/2 |x - target|^2 per attachment of a bone. Constants in materials.h.
class ElasticBody {
 public:
  ElasticBody(const TetMesh& mesh, const Tissue& tissue, const std::vector<Attachment>& attachments);

  // x, gradient: N x 3, metres and newtons (gradient of the energy: minus the force). The gradient is left undefined
  // when the energy is infinite.
  ElasticForces evaluate(const Positions& x, const Drive& drive, Positions& gradient) const;

  // N x N: a constant scalar operator near the energy's Hessian for any rotation; positive definite once bones hold.
  Eigen::SparseMatrix<double> metric() const;

  const std::vector<Attachment>& attachments() const { return attachments_; }

 private:
  struct Element {
    int node[4];
    int muscle;
    double inverse_edges[9];  // Dm^-1, row-major
    double volume;
    double shear;
    double fibre[3];
  };
  // Adds the element's forces; false when it has no positive volume.
  bool add_element(const Element& element, const Positions& x, const Drive& drive, Positions& gradient,
                   ElasticForces& forces) const;

  const TetMesh& mesh_;
  std::vector<Element> elements_;
  const std::vector<Attachment>& attachments_;
};

}  // namespace bodyopt
