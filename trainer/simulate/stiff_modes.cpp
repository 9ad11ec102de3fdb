#include "trainer/simulate/stiff_modes.h"

namespace bodyopt::trainer {

StiffModes::StiffModes(const Metric& metric, Eigen::Index node_count, std::vector<SparseMode> modes,
                       const std::vector<double>& stiffness)
    : metric_(metric), modes_(std::move(modes)) {
  const auto count = static_cast<Eigen::Index>(modes_.size());
  Eigen::MatrixXd small(count, count);
  Positions solved(node_count, 3);
  Metric::Scratch scratch;
  for (Eigen::Index m = 0; m < count; ++m) {
    solved.setZero();
    for (const auto& [node, vector] : modes_[static_cast<std::size_t>(m)]) solved.row(node) += vector;
    metric_.solve(solved, scratch);
    small.col(m) = project(solved);
    small(m, m) += 1 / stiffness[static_cast<std::size_t>(m)];
  }
  small_ = Cholesky(std::move(small));
}

Eigen::VectorXd StiffModes::project(const Positions& values) const {
  Eigen::VectorXd result(static_cast<Eigen::Index>(modes_.size()));
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    double sum = 0;
    for (const auto& [node, vector] : modes_[m]) sum += vector.dot(values.row(node));
    result[static_cast<Eigen::Index>(m)] = sum;
  }
  return result;
}

// A is the metric, G has the modes as columns. The result is A^-1 (v - G c), c = (1 / stiffness + G^T A^-1 G)^-1 G^T
// A^-1 v. A second solve with A reads less than A^-1 G would take.
void StiffModes::solve(Positions& values, Metric::Scratch& scratch) const {
  if (modes_.empty()) return metric_.solve(values, scratch);
  Positions solved = values;
  metric_.solve(solved, scratch);
  const Eigen::VectorXd share = small_.solve(project(solved));
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    for (const auto& [node, vector] : modes_[m]) values.row(node) -= share[static_cast<Eigen::Index>(m)] * vector;
  }
  metric_.solve(values, scratch);
}

}  // namespace bodyopt::trainer
