#include "trainer/train/skinning/near_smoother.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <queue>
#include <utility>

namespace bodyopt::trainer {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

// How many decay lengths `steps` steps carry anything worth keeping. A step's kernel falls as exp(-r). After p of them
// at most exp(-y r) / (1 - y^2)^p is left at r for any y < 1 (Chernoff), here 0.6. That makes 3e-6 along a straight
// line; ways along edges are longer: on bodies of 180 to 13,380 vertices 3e-9 was left at most.
double reach_of(int steps) { return 21 + 0.75 * steps; }

// A lattice's kernel falls by exp(-acosh(1 + edge^2 / 2)) from vertex to vertex, lengths in those of the decay. Between
// six neighbours, edge^2 is two thirds of the area over the edge's entry.
Eigen::SparseMatrix<double> decay_lengths(const Eigen::VectorXd& areas, const Eigen::SparseMatrix<double>& laplacian) {
  Eigen::SparseMatrix<double> lengths = laplacian;
  for (int column = 0; column < lengths.outerSize(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator edge(lengths, column); edge; ++edge) {
      const double area = std::min(areas[column], areas[edge.row()]);
      edge.valueRef() = edge.value() < 0 ? std::acosh(1 - area / (3 * edge.value())) : kFar;
    }
  }
  return lengths;
}

}  // namespace

NearSmoother::NearSmoother(Eigen::VectorXd areas, const Eigen::SparseMatrix<double>& laplacian, int steps)
    : areas_(std::move(areas)), steps_(steps), lengths_(decay_lengths(areas_, laplacian)) {
  Eigen::SparseMatrix<double> matrix = laplacian;
  matrix.diagonal() += areas_;
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor(matrix);
  is_solvable_ = factor.info() == Eigen::Success;
  if (!is_solvable_) return;
  const auto& row = factor.permutationP().indices();
  row_.assign(row.data(), row.data() + row.size());
  factor_ = factor_panels<double>(factor.matrixL());
  for (std::size_t p = 0; p < factor_.panels.size(); ++p) {
    panel_.insert(panel_.end(), static_cast<std::size_t>(factor_.panels[p].width), static_cast<int>(p));
  }
}

std::vector<int> NearSmoother::around(const std::vector<int>& vertices) const {
  using Step = std::pair<double, int>;
  std::priority_queue<Step, std::vector<Step>, std::greater<>> front;
  std::vector<double> distance(row_.size(), kFar);
  std::vector<int> reached = vertices;
  for (const int v : vertices) distance[static_cast<std::size_t>(v)] = 0, front.push({0, v});
  const double reach = reach_of(steps_);
  while (!front.empty()) {
    const auto [way, vertex] = front.top();
    front.pop();
    if (way > distance[static_cast<std::size_t>(vertex)]) continue;
    for (Eigen::SparseMatrix<double>::InnerIterator edge(lengths_, vertex); edge; ++edge) {
      double& other = distance[static_cast<std::size_t>(edge.row())];
      const double longer = way + edge.value();
      if (!(longer <= reach && longer < other)) continue;
      if (other == kFar) reached.push_back(static_cast<int>(edge.row()));
      other = longer;
      front.push({longer, static_cast<int>(edge.row())});
    }
  }
  return reached;
}

std::vector<int> NearSmoother::panels_of(const std::vector<int>& vertices) const {
  std::vector<bool> is_in(factor_.panels.size(), false);
  std::vector<int> panels;
  for (const int v : vertices) {
    int panel = panel_[static_cast<std::size_t>(row_[static_cast<std::size_t>(v)])];
    while (!is_in[static_cast<std::size_t>(panel)]) {
      is_in[static_cast<std::size_t>(panel)] = true;
      panels.push_back(panel);
      const FactorPanel& own = factor_.panels[static_cast<std::size_t>(panel)];
      if (own.row_begin == own.row_end) break;
      panel = panel_[static_cast<std::size_t>(factor_.rows[static_cast<std::size_t>(own.row_begin)])];
    }
  }
  std::ranges::sort(panels);
  return panels;
}

TenColumns NearSmoother::operator()(const TenColumns& from) const {
  TenColumns result{around(from.vertices), {}};
  const std::vector<int> panels = panels_of(result.vertices);
  // Rows of other panels are never touched: their pages cost nothing.
  const auto values = std::make_unique_for_overwrite<double[]>(10 * row_.size());
  const auto values_at = [&](int row) {
    return Eigen::Map<Eigen::Matrix<double, 1, 10>>(values.get() + 10 * std::ptrdiff_t{row});
  };
  const auto row_of = [&](int vertex) { return row_[static_cast<std::size_t>(vertex)]; };
  const auto for_rows = [&](const auto& visit) {
    for (const int p : panels) {
      const FactorPanel& panel = factor_.panels[static_cast<std::size_t>(p)];
      for (int row = panel.first; row < panel.first + panel.width; ++row) visit(row);
    }
  };
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(areas_.size());  // by row; none further away
  for (const int v : result.vertices) areas[row_of(v)] = areas_[v];
  for_rows([&](int row) { values_at(row).setZero(); });
  for (std::size_t k = 0; k < from.vertices.size(); ++k) {
    values_at(row_of(from.vertices[k])) = from.values.row(static_cast<Eigen::Index>(k));
  }
  for (int step = 0; step < steps_; ++step) {
    for_rows([&](int row) { values_at(row) *= areas[row]; });
    solve_ten_in(factor_, panels, values.get());
  }
  result.values.resize(static_cast<Eigen::Index>(result.vertices.size()), 10);
  for (std::size_t k = 0; k < result.vertices.size(); ++k) {
    result.values.row(static_cast<Eigen::Index>(k)) = values_at(row_of(result.vertices[k]));
  }
  return result;
}

}  // namespace bodyopt::trainer
