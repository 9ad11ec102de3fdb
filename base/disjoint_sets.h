// Sets of elements that belong together, joined pair by pair (union-find).
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace bodyopt {

// A set is known by its lowest element (Tarjan 1975, with path halving).
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : lowest_(count) {
    std::iota(lowest_.begin(), lowest_.end(), std::size_t{0});
  }

  std::size_t lowest(std::size_t element) {
    while (lowest_[element] != element) element = lowest_[element] = lowest_[lowest_[element]];
    return element;
  }
  void join(std::size_t a, std::size_t b) {
    const std::size_t x = lowest(a), y = lowest(b);
    lowest_[std::max(x, y)] = std::min(x, y);
  }

 private:
  std::vector<std::size_t> lowest_;  // of each, one of its set that is no higher
};

}  // namespace bodyopt
