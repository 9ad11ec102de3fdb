#include "trainer/simulate/lbfgs.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace bodyopt::trainer {
namespace {

constexpr std::size_t kMemory = 10;
constexpr double kArmijo = 1e-4;
constexpr int kMaxHalvings = 30;
// Relative rounding of an energy: smaller differences cannot tell up from down.
constexpr double kEnergyRounding = 1e-12;
// Joules. A sum over all tets cannot show a change this small: the slopes at both ends show it instead.
constexpr double kSmallEnergy = 1e-9;

double dot(const auto& a, const Positions& b) { return a.template cast<double>().cwiseProduct(b).sum(); }

}  // namespace

// The two-loop recursion (Nocedal and Wright, algorithm 7.4): direction = - inverse Hessian x gradient.
void Lbfgs::direction_from(const Positions& gradient, Positions& direction) {
  std::vector<double> alpha(memory_.size());
  direction = -gradient;
  for (std::size_t k = memory_.size(); k-- > 0;) {
    alpha[k] = dot(memory_[k].step, direction) / memory_[k].curvature;
    direction.noalias() -= alpha[k] * memory_[k].change.cast<double>();
  }
  metric_.solve(direction, scratch_);
  for (std::size_t k = 0; k < memory_.size(); ++k) {
    const double beta = dot(memory_[k].change, direction) / memory_[k].curvature;
    direction.noalias() += (alpha[k] - beta) * memory_[k].step.cast<double>();
  }
}

MinimiseResult Lbfgs::minimise(const Objective& objective, double tolerance, int max_iterations, Positions& nodes) {
  Positions gradient(nodes.rows(), 3), direction, trial, trial_gradient(nodes.rows(), 3);
  ObjectiveValue value = objective(nodes, gradient);
  MinimiseResult result;
  const auto residual = [&] { return gradient.norm() / std::max(std::sqrt(value.force_square), force_floor_); };
  result.residual = residual();
  double longest = 1;  // to try: where steps had to be short, the next will be too
  while (result.residual >= tolerance && result.iterations < max_iterations) {
    direction_from(gradient, direction);
    const double slope = dot(gradient, direction);
    const double furthest = direction.rowwise().norm().maxCoeff();
    const double allowed = max_move_ / furthest;
    double length = slope < 0 ? std::min(longest, allowed) : 0;
    ObjectiveValue next;
    for (int halving = 0; length > 0; ++halving) {
      trial.noalias() = nodes + length * direction;
      next = objective(trial, trial_gradient);
      const double expected = kArmijo * length * slope;
      if (next.energy <= value.energy + expected + kEnergyRounding * std::abs(value.energy)) break;
      if (-length * slope < kSmallEnergy && std::isfinite(next.energy) &&
          length * (slope + dot(trial_gradient, direction)) / 2 <= expected) {
        break;
      }
      length = halving < kMaxHalvings ? length / 2 : 0;
    }
    ++result.iterations;
    if (!(length > 0)) {
      if (memory_.empty()) break;  // the plain metric step fails too: nothing lower can be found
      memory_.clear();
      longest = 1;
      continue;
    }
    Pair pair{(trial - nodes).cast<float>(), (trial_gradient - gradient).cast<float>(), 0};
    pair.curvature = pair.step.cwiseProduct(pair.change).cast<double>().sum();
    nodes.swap(trial);
    gradient.swap(trial_gradient);
    value = next;
    if (length < allowed) longest = std::min(1.0, 2 * length);
    result.residual = residual();
    if (pair.curvature > 0) {
      memory_.push_back(std::move(pair));
      if (memory_.size() > kMemory) memory_.pop_front();
    }
  }
  return result;
}

}  // namespace bodyopt::trainer
