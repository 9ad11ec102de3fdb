#include "trainer/simulate/lbfgs.h"

#include <cmath>
#include <deque>

namespace bodyopt {
namespace {

constexpr std::size_t kMemory = 8;
constexpr double kArmijo = 1e-4;
constexpr int kMaxHalvings = 30;
// Relative rounding of an energy: smaller differences cannot tell up from down.
constexpr double kEnergyRounding = 1e-12;

double dot(const Positions& a, const Positions& b) { return a.cwiseProduct(b).sum(); }

struct Pair {
  Positions step, change;  // of the nodes, of the gradient
  double curvature;        // step . change
};

// The two-loop recursion (Nocedal and Wright, algorithm 7.4): direction = - inverse Hessian x gradient.
void direction_from(const std::deque<Pair>& memory, const StiffModes& metric, const Positions& gradient,
                    Positions& direction, Positions& scratch) {
  std::vector<double> alpha(memory.size());
  direction = -gradient;
  for (std::size_t k = memory.size(); k-- > 0;) {
    alpha[k] = dot(memory[k].step, direction) / memory[k].curvature;
    direction.noalias() -= alpha[k] * memory[k].change;
  }
  metric.solve(direction, scratch);
  for (std::size_t k = 0; k < memory.size(); ++k) {
    const double beta = dot(memory[k].change, direction) / memory[k].curvature;
    direction.noalias() += (alpha[k] - beta) * memory[k].step;
  }
}

}  // namespace

MinimiseResult minimise(const Objective& objective, const StiffModes& metric, double tolerance, double force_floor,
                        int max_iterations, Positions& nodes) {
  std::deque<Pair> memory;
  Positions gradient(nodes.rows(), 3), direction, scratch, trial, trial_gradient(nodes.rows(), 3);
  ObjectiveValue value = objective(nodes, gradient);
  MinimiseResult result;
  const auto residual = [&] { return gradient.norm() / std::max(std::sqrt(value.force_square), force_floor); };
  result.residual = residual();
  while (result.residual >= tolerance && result.iterations < max_iterations) {
    direction_from(memory, metric, gradient, direction, scratch);
    const double slope = dot(gradient, direction);
    double length = slope < 0 ? 1 : 0;
    ObjectiveValue next;
    for (int halving = 0; length > 0; ++halving) {
      trial.noalias() = nodes + length * direction;
      next = objective(trial, trial_gradient);
      if (next.energy <= value.energy + kArmijo * length * slope + kEnergyRounding * std::abs(value.energy)) break;
      length = halving < kMaxHalvings ? length / 2 : 0;
    }
    ++result.iterations;
    if (!(length > 0)) {
      if (memory.empty()) break;  // the plain metric step fails too: nothing lower can be found
      memory.clear();
      continue;
    }
    Pair pair{trial - nodes, trial_gradient - gradient, 0};
    pair.curvature = dot(pair.step, pair.change);
    nodes.swap(trial);
    gradient.swap(trial_gradient);
    value = next;
    result.residual = residual();
    if (pair.curvature > 0) {
      memory.push_back(std::move(pair));
      if (memory.size() > kMemory) memory.pop_front();
    }
  }
  return result;
}

}  // namespace bodyopt
