// A few stiff directions on top of the constant metric.
#pragma once

#include <utility>
#include <vector>

#include "base/linear_algebra.h"
#include "trainer/simulate/metric.h"

namespace bodyopt::trainer {

// A direction in the space of all nodes that moves few of them: (node, vector).
using SparseMode = std::vector<std::pair<int, Eigen::RowVector3d>>;

// Inverse of metric + sum over modes of stiffness g g^T, by the Woodbury identity.
class StiffModes {
 public:
  // `metric` must outlive it. One stiffness above 0 for every mode.
  StiffModes(const Metric& metric, Eigen::Index node_count, std::vector<SparseMode> modes,
             const std::vector<double>& stiffness);

  // Replaces values (N x 3) by the inverse times values. scratch: any; it is resized.
  void solve(Positions& values, Metric::Scratch& scratch) const;

 private:
  // The share of values (N x 3) along every mode.
  Eigen::VectorXd project(const Positions& values) const;

  const Metric& metric_;
  std::vector<SparseMode> modes_;
  Cholesky small_;
};

}  // namespace bodyopt::trainer
