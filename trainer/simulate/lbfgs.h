// Minimisation by L-BFGS in a constant metric.
#pragma once

#include <functional>

#include "trainer/simulate/stiff_modes.h"

namespace bodyopt {

// What is minimised, at one point.
struct ObjectiveValue {
  double energy = 0;        // joules; infinite where the point is not allowed
  double force_square = 0;  // N^2, the scale of the forces that balance; see residual
};
// Sets `gradient` (N x 3).
using Objective = std::function<ObjectiveValue(const Positions& nodes, Positions& gradient)>;

struct MinimiseResult {
  double residual = 0;  // |gradient| / sqrt(force_square): the force left over relative to the forces in balance
  int iterations = 0;
};

// Improves `nodes` until the residual is below `tolerance`, `max_iterations` are done, or no step lowers the energy any
// more. The first factor of the inverse Hessian is the metric's inverse; steps obey Armijo's rule and never enter a
// place of infinite energy. `nodes` must start at finite energy. The residual returned belongs to the nodes returned.
// `force_floor` (N): forces below it count as none.
MinimiseResult minimise(const Objective& objective, const StiffModes& metric, double tolerance, double force_floor,
                        int max_iterations, Positions& nodes);

}  // namespace bodyopt
