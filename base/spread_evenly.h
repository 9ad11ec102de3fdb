// A few of many.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace bodyopt {

// Returns at most `most` of the numbers 0 .. count - 1, spread evenly.
inline std::vector<std::size_t> spread_evenly(std::size_t count, std::size_t most) {
  std::vector<std::size_t> numbers(std::min(count, most));
  for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] = k * count / numbers.size();
  return numbers;
}

// Returns them likewise, each in the middle of its share of the numbers.
inline std::vector<std::size_t> spread_in_middles(std::size_t count, std::size_t most) {
  std::vector<std::size_t> numbers(std::min(count, most));
  for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] = (2 * k + 1) * count / (2 * numbers.size());
  return numbers;
}

}  // namespace bodyopt
