#include "trainer/simulate/equilibrium.h"

#include <cmath>
#include <deque>

#include "runtime/basis/error.h"

namespace bodyopt {
namespace {

constexpr std::size_t kHistory = 8;

double dot_product(const Positions& a, const Positions& b) { return a.cwiseProduct(b).sum(); }

// Forces below this are rounding, newtons: a body at rest has nothing to be relative to.
constexpr double kNoForce = 1e-7;

double residual_of(const Positions& gradient, const ElasticForces& forces) {
  const double net = gradient.norm();
  return net < kNoForce ? 0 : net / std::max(forces.element_norm, kNoForce);
}

// The two-loop recursion of L-BFGS around a solve in the metric.
class Direction {
 public:
  explicit Direction(const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>>& metric) : metric_(metric) {}

  Positions operator()(const Positions& gradient) const {
    Positions q = gradient;
    std::vector<double> alpha(pairs_.size());
    for (std::size_t k = pairs_.size(); k-- > 0;) {
      alpha[k] = dot_product(pairs_[k].step, q) / pairs_[k].curvature;
      q -= alpha[k] * pairs_[k].change;
    }
    q = metric_.solve(q).eval();
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const double beta = dot_product(pairs_[k].change, q) / pairs_[k].curvature;
      q += (alpha[k] - beta) * pairs_[k].step;
    }
    return -q;
  }

  void learn(Positions step, Positions change) {
    const double curvature = dot_product(step, change);
    if (!(curvature > 1e-12 * step.norm() * change.norm())) return;
    if (pairs_.size() == kHistory) pairs_.pop_front();
    pairs_.push_back({std::move(step), std::move(change), curvature});
  }

  bool empty() const { return pairs_.empty(); }
  void forget() { pairs_.clear(); }

 private:
  struct Pair {
    Positions step, change;  // of positions and of gradients
    double curvature;
  };
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>>& metric_;
  std::deque<Pair> pairs_;
};

}  // namespace

EquilibriumSolver::EquilibriumSolver(const ElasticBody& body) : body_(body), metric_(body.metric()) {
  if (metric_.info() != Eigen::Success) {
    throw Error(ErrorKind::mismatch,
                "bones do not hold every piece of the body: a part of the skin has no joint inside it (is the skeleton "
                "inside the skin, in the same units?)");
  }
}

SolveResult EquilibriumSolver::solve(Positions& x, const Drive& drive, double tolerance, int most_iterations) const {
  Positions gradient, trial, trial_gradient;
  ElasticForces forces = body_.evaluate(x, drive, gradient);
  SolveResult result;
  result.inverted = forces.inverted;
  result.residual = 1;
  if (forces.inverted > 0) return result;
  Direction direction(metric_);
  for (; result.iterations < most_iterations; ++result.iterations) {
    result.residual = residual_of(gradient, forces);
    if (result.residual < tolerance) return result;
    Positions move = direction(gradient);
    double slope = dot_product(move, gradient);
    if (!(slope < 0)) {
      direction.forget();
      move = direction(gradient);
      slope = dot_product(move, gradient);
    }
    double length = 1;
    ElasticForces next;
    for (int halving = 0;; ++halving, length *= 0.5) {
      trial = x + length * move;
      next = body_.evaluate(trial, drive, trial_gradient);
      if (next.energy <= forces.energy + 1e-4 * length * slope) break;
      // The energy cannot be told apart any more, but the forces still fall.
      if (std::abs(slope) * length < 1e-12 * std::abs(forces.energy) && trial_gradient.norm() < gradient.norm()) break;
      if (halving == 40) {
        if (direction.empty()) return result;
        direction.forget();
        length = 0;
        trial = x;
        trial_gradient = gradient;
        next = forces;
        break;
      }
    }
    if (length > 0) direction.learn(trial - x, trial_gradient - gradient);
    x.swap(trial);
    gradient.swap(trial_gradient);
    forces = next;
  }
  result.residual = residual_of(gradient, forces);
  return result;
}

}  // namespace bodyopt
