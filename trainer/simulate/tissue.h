// Elastic energy of the tetrahedra and its gradient.
#pragma once

#include <span>
#include <vector>

#include "geometry/tet_mesh.h"
#include "trainer/simulate/materials.h"
#include "trainer/simulate/quadrature_points.h"
#include "trainer/simulate/tissue_batches.h"

namespace bodyopt::trainer {

// Energy density per tet, with F the deformation gradient, J = det F, a the fibre direction and s = |F a|.
//   `mu/2 (|F|^2 - 3) + lambda/2 ((J - 1 - mu/lambda)^2 - (mu/lambda)^2)`: stable neo-Hookean (Smith et al. 2018)
//   without its singular log term.
//   `kappa (J - b)^2 (-ln(J / b))` where J < b = kBarrierVolume: a barrier; kappa = kBarrierWeight lambda.
//   Its tangent below J = shape.steepest lets inverted tets recover; shape.least_volume raises kappa in tiny tets.
//   `activation k_a/2 (s - slack)^2` where s > slack, muscles only (FibreDrive).
//   `k_p/2 (s - 1)^2` where s > 1, muscles only.
// Zero with zero gradient at rest when all activations are zero.
//
// A tet of second order has four points at which this is summed, the rule of degree 2. Each has the deformation
// gradient of a linear tet whose corners are sums of the ten nodes. What is said of tets is true of these.
class Tissue {
 public:
  // tets: one material per tet, as are fibres. A tet may have fibres of several muscles.
  Tissue(const TetMesh& mesh, const std::vector<TetMaterial>& tets, std::vector<FibreTet> fibres,
         const Materials& materials = {});

  // A tet compressed below this share of its volume is pushed back by a logarithmic barrier, so many lambdas strong.
  static constexpr double kBarrierVolume = 0.3, kBarrierWeight = 2;

  struct BarrierShape {
    // The volume ratio below which the barrier goes on as a straight line. Were it infinite at J = 0, the smallest tet
    // would stop every step of all others.
    double steepest;
    // Relative to the mean volume of all tets: smaller ones get the barrier of one as large.
    double least_volume;
  };
  // The steep one holds up soft tets, nearly empty, against stiff neighbours; the firm one tiny tets, which large
  // neighbours press inside out unfelt. From far away tiny tets that are firm would stop all others.
  static constexpr BarrierShape kBarrier{0.005, 0}, kSteepBarrier{0.002, 0}, kFirmBarrier{0.002, 1e-3};

  // Adds the gradient (joules per metre, N x 3) of the energy at `nodes` (N x 3) to `gradient`. drives: per muscle.
  TissueSum add_gradient(const Positions& nodes, std::span<const FibreDrive> drives, Positions& gradient,
                         const BarrierShape& shape = kBarrier) const;

  struct Inverted {
    int tets = 0;
    double share = 0;  // of the volume at rest
  };
  Inverted inverted(const Positions& nodes) const;  // tets with J <= 0

 private:
  void add_batches(const TetMesh& mesh, const std::vector<TetMaterial>& tets, std::vector<FibreTet> fibres);
  void add_further(const TetMesh& mesh, const std::vector<FibreTet>& fibres);

  QuadraturePoints points_;  // none in linear tets
  TissueBatches batches_;
  double mean_volume_ = 0;  // of a tet, cubic metres
};

}  // namespace bodyopt::trainer
