#include "trainer/simulate/stiff_modes.h"

namespace bodyopt {

StiffModes::StiffModes(const Metric& metric, Eigen::Index node_count, std::vector<SparseMode> modes,
                       const std::vector<double>& stiffness)
    : metric_(metric), modes_(std::move(modes)) {
  const auto count = static_cast<Eigen::Index>(modes_.size());
  Eigen::MatrixXd small(count, count);
  Positions scratch;
  for (const SparseMode& mode : modes_) {
    Positions& column = solved_.emplace_back(Positions::Zero(node_count, 3));
    for (const auto& [node, vector] : mode) column.row(node) += vector;
    metric_.solve(column, scratch);
    small.col(static_cast<Eigen::Index>(solved_.size()) - 1) = project(column);
  }
  for (Eigen::Index m = 0; m < count; ++m) small(m, m) += 1 / stiffness[static_cast<std::size_t>(m)];
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

void StiffModes::solve(Positions& values, Positions& scratch) const {
  metric_.solve(values, scratch);
  if (modes_.empty()) return;
  const Eigen::VectorXd share = small_.solve(project(values));
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    values.noalias() -= share[static_cast<Eigen::Index>(m)] * solved_[m];
  }
}

}  // namespace bodyopt
