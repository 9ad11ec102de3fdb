// Places of the values that a condition holds for.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace bodyopt {

// The places of these values, rising, as rows of a matrix are numbered.
template <typename Values, typename Holds>
std::vector<Eigen::Index> rows_where(const Values& values, const Holds& holds) {
  std::vector<Eigen::Index> rows;
  Eigen::Index row = 0;
  for (const auto& value : values) {
    if (holds(value)) rows.push_back(row);
    ++row;
  }
  return rows;
}

}  // namespace bodyopt
