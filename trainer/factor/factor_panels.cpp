#include "trainer/factor/factor_panels.h"

#include <algorithm>

namespace bodyopt::trainer {
namespace {

// A panel may have this share of zeros. A zero costs a multiplication, and saves reading and writing a row once more.
constexpr double kMostZeros = 0.25;

using Lower = Eigen::SparseMatrix<double>;
constexpr int kWidest = FactorPanels<double>::kWidest;

int rows_below(const Lower& lower, int column) { return static_cast<int>(lower.col(column).nonZeros()) - 1; }

// The first row below the diagonal: its parent in the elimination tree, which has all rows of the column but that one.
int parent_of(const Lower& lower, int column) {
  Lower::InnerIterator it(lower, column);
  ++it;
  return it ? static_cast<int>(it.row()) : -1;
}

int width_from(const Lower& lower, int first) {
  int width = 1, kept = rows_below(lower, first);
  while (width < kWidest && parent_of(lower, first + width - 1) == first + width) {
    const int below = rows_below(lower, first + width);
    kept += below;
    const int dense = (width + 1) * below + width * (width + 1) / 2;
    if (dense - kept > kMostZeros * dense) break;
    ++width;
  }
  return width;
}

template <typename Number>
void add_panel(const Lower& lower, int first, FactorPanels<Number>& factor) {
  const int width = width_from(lower, first), last = first + width - 1;
  FactorPanel panel{first, width, static_cast<int>(factor.rows.size()), 0, factor.values.size()};
  Lower::InnerIterator it(lower, last);
  for (++it; it; ++it) factor.rows.push_back(static_cast<int>(it.row()));
  panel.row_end = static_cast<int>(factor.rows.size());
  const std::size_t triangle = static_cast<std::size_t>(width * (width - 1) / 2);
  const auto count = static_cast<std::size_t>(panel.row_end - panel.row_begin);
  factor.values.resize(panel.first_value + triangle + count * static_cast<std::size_t>(width), Number(0));
  Number* const own = factor.values.data() + panel.first_value;
  for (int k = 0; k < width; ++k) {
    int at = panel.row_begin;
    for (Lower::InnerIterator entry(lower, first + k); entry; ++entry) {
      const int row = static_cast<int>(entry.row()), below = row - first;
      const auto value = static_cast<Number>(entry.value());
      if (below == k) {
        factor.inverse_diagonal.push_back(1 / entry.value());
      } else if (below < width) {
        own[below * (below - 1) / 2 + k] = value;
      } else {
        at = static_cast<int>(std::lower_bound(factor.rows.begin() + at, factor.rows.end(), row) - factor.rows.begin());
        own[triangle + static_cast<std::size_t>((at - panel.row_begin) * width + k)] = value;
      }
    }
  }
  factor.panels.push_back(panel);
}

}  // namespace

template <typename Number>
FactorPanels<Number> factor_panels(const Lower& lower) {
  FactorPanels<Number> factor;
  for (int column = 0; column < lower.cols(); column += factor.panels.back().width) add_panel(lower, column, factor);
  return factor;
}

template FactorPanels<float> factor_panels(const Lower& lower);
template FactorPanels<double> factor_panels(const Lower& lower);

}  // namespace bodyopt::trainer
