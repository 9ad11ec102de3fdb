// Minimisation by L-BFGS in a constant metric.
#pragma once

#include <deque>
#include <functional>
#include <limits>

#include "trainer/simulate/stiff_modes.h"

namespace bodyopt::trainer {

// The objective at one point.
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

// Remembers the last steps from one call of `minimise` to the next, which may be of another objective if its curvature
// is about the same. The first factor of the inverse Hessian is the metric's inverse.
class Lbfgs {
 public:
  // metric must outlive it. `force_floor` (N): forces below it count as none. `max_move` (metres): no step moves a node
  // further, since the energy far away has nothing to do with the slope here.
  Lbfgs(const StiffModes& metric, double force_floor, double max_move = std::numeric_limits<double>::infinity())
      : metric_(metric), force_floor_(force_floor), max_move_(max_move) {}

  // Improves `nodes` until the residual is below `tolerance`, `max_iterations` are done, or no step lowers the energy
  // any more. Steps obey Armijo's rule and never enter a place of infinite energy. `nodes` must start at finite energy.
  // The residual returned belongs to the nodes returned.
  MinimiseResult minimise(const Objective& objective, double tolerance, int max_iterations, Positions& nodes);

 private:
  // Single precision is enough for a direction, and all of them are read in every iteration.
  using Change = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
  struct Pair {
    Change step, change;  // of the nodes, of the gradient
    double curvature;     // step . change
  };
  void direction_from(const Positions& gradient, Positions& direction);

  const StiffModes& metric_;
  double force_floor_, max_move_;
  std::deque<Pair> memory_;
  Metric::Scratch scratch_;
};

}  // namespace bodyopt::trainer
