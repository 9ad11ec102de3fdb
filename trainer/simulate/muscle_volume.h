// Muscles keep their volume, each as a whole.
#pragma once

#include <vector>

#include "trainer/simulate/stiff_modes.h"
#include "trainer/simulate/tissue.h"

namespace bodyopt::trainer {

// Muscle is nearly incompressible, but linear tets held to their true bulk modulus one by one lock. Each tet is
// therefore softer (materials.h). The volume of each muscle as a whole is held by
//   energy = K/2 V_rest (V / V_rest - 1)^2.
// The penalty that pressure by whole bodies instead of elements is: mean dilatation with one patch per muscle
// (Nagtegaal, Parks and Rice 1974).
class MuscleVolume {
 public:
  // A tet counts with its fibres' share of it.
  MuscleVolume(const TetMesh& mesh, const std::vector<FibreTet>& fibres, std::size_t muscle_count,
               const Materials& materials = {});

  // Adds the gradient (J/m, N x 3) at `nodes` to `gradient`; returns the energy, joules.
  double add_gradient(const Positions& nodes, Positions& gradient) const;

  // The energy's stiff directions at `nodes`, one per muscle that has tets: the gradient of its volume (square metres);
  // and their stiffness K / V_rest.
  std::pair<std::vector<SparseMode>, std::vector<double>> stiff_modes(const Positions& nodes) const;

  // V / V_rest - 1 of the muscle that changes most; 0 without muscles.
  double largest_change(const Positions& nodes) const;

 private:
  struct Part {
    int node[4];
    int muscle;
    double share;
  };
  static Eigen::Matrix<double, 4, 3> volume_slope(const Part& part, const Positions& nodes);
  std::vector<double> volumes(const Positions& nodes) const;

  std::vector<Part> parts_;
  std::vector<double> rest_;  // per muscle, cubic metres
  double bulk_;               // K, Pa
};

}  // namespace bodyopt::trainer
