// Quantiles of values in any order, one at least.
#pragma once

#include <algorithm>
#include <cstddef>

namespace bodyopt {

// The value at this place in ascending order, from 0.
template <typename Values>
auto value_at_rank(Values values, std::ptrdiff_t rank) {
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<decltype(values.size())>(rank)];
}

// The value that this share of the others, from 0 to 1, does not exceed.
template <typename Values>
auto quantile(const Values& values, double share) {
  return value_at_rank(values, static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1)));
}

// Of an even number of values, the upper one of the two in the middle.
template <typename Values>
auto median(const Values& values) {
  return value_at_rank(values, static_cast<std::ptrdiff_t>(values.size()) / 2);
}

}  // namespace bodyopt
