// Elastic energy of the tetrahedra and its gradient.
#pragma once

#include <span>
#include <vector>

#include "geometry/tet_mesh.h"
#include "trainer/simulate/materials.h"
#include "trainer/simulate/muscle_fibres.h"

namespace bodyopt {

// A tet of a muscle: where its fibres run, and whose activation drives them.
struct FibreTet {
  int tet;
  int muscle;
  Eigen::Vector3d direction;  // unit, rest space
  double share = 1;           // of the tet's volume that is this muscle
};

// Energy density per tet, F the deformation gradient, J = det F, a the fibre direction, s = |F a|:
//   mu/2 (|F|^2 - 3) + lambda/2 ((J - 1 - mu/lambda)^2 - (mu/lambda)^2)        stable neo-Hookean (Smith et al. 2018),
//                                                                               without its singular log term
//   + kappa (J - b)^2 (-ln(J / b)), b = kBarrierVolume,  where J < b; its tangent below J = shape.steepest:
//     kappa = kBarrierWeight lambda, shape.least_volume   inverted tets recover
//     mean volume / volume times as much in tiny tets
//   + activation k_a/2 (s - slack)^2                     where s > slack, muscles only (FibreDrive)
//   + k_p/2 (s - 1)^2                                    where s > 1, muscles only
// Zero with zero gradient at rest when all activations are zero.
class Tissue {
 public:
  // tets: one material per tet. A tet may have fibres of several muscles.
  Tissue(const TetMesh& mesh, const std::vector<TetMaterial>& tets, std::vector<FibreTet> fibres,
         const Materials& materials = {});

  struct Sum {
    double energy = 0;        // joules
    double force_square = 0;  // N^2: over all tets, the squared forces each puts on its four nodes
  };

  // A tet compressed below this share of its volume is pushed back by a logarithmic barrier, so many lambdas strong.
  static constexpr double kBarrierVolume = 0.3, kBarrierWeight = 2;

  struct BarrierShape {
    // The volume ratio below which the barrier goes on as a straight line. Were it infinite at J = 0, the smallest tet
    // would stop every step of all others.
    double steepest;
    // Of the mean volume of all tets: smaller ones get the barrier of one as large.
    double least_volume;
  };
  // The steep one holds up soft tets, nearly empty, against stiff neighbours; the firm one tiny tets, which large
  // neighbours press inside out unfelt. From far away tiny tets that are firm would stop all others.
  static constexpr BarrierShape kBarrier{0.005, 0}, kSteepBarrier{0.002, 0}, kFirmBarrier{0.002, 1e-3};

  // Adds the gradient (joules per metre, N x 3) of the energy at `nodes` (N x 3) to `gradient`. drives: per muscle.
  Sum add_gradient(const Positions& nodes, std::span<const FibreDrive> drives, Positions& gradient,
                   const BarrierShape& shape = kBarrier) const;

  struct Inverted {
    int tets = 0;
    double share = 0;  // of the volume at rest
  };
  Inverted inverted(const Positions& nodes) const;  // tets with J <= 0

 private:
  static constexpr int kLanes = 8;

  // Eight tets side by side, so that the compiler works on several at once. Empty lanes have no volume.
  struct Batch {
    int node[4][kLanes];
    double slope[3][3][kLanes];  // gradient of the shape functions of corners 1..3, 1/m; corner 0: minus their sum
    double volume[kLanes], mu[kLanes], lambda[kLanes];
  };
  struct FibreBatch {
    double slope[3][kLanes];  // the same slopes along the fibre
    double volume[kLanes];    // zero in lanes without fibres
    int muscle[kLanes];
  };
  struct Corners;
  struct Strain;

  // Of muscles that share their tets with those of fibres_.
  struct FurtherFibres {
    int node[4][kLanes];
    FibreBatch fibres;
  };

  void add_further(const TetMesh& mesh, const std::vector<FibreTet>& fibres);
  void gather(const int (&node)[4][kLanes], const Positions& nodes, Corners& corners) const;
  void scatter(const int (&node)[4][kLanes], const double (&force)[3][3][kLanes], Positions& gradient, Sum& sum) const;
  double strain(const Batch& batch, const Corners& corners, Strain& strain) const;
  double fibre_force(const FibreBatch& batch, const Corners& corners, std::span<const FibreDrive> drives,
                     double (&force)[3][3][kLanes]) const;

  std::vector<Batch> batches_;
  std::vector<FibreBatch> fibres_;  // of the first batches
  std::vector<FurtherFibres> further_;
  double active_, passive_;
  double mean_volume_ = 0;  // of a tet, cubic metres
};

}  // namespace bodyopt
