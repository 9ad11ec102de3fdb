// The error to expect of every vertex: what coverage says of regions, by the share each has in what a vertex learned.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

// A basis does not keep the weights of its regions, but the squares of what a region's components add to a vertex are
// in proportion to them.
class RegionShares {
 public:
  RegionShares() = default;
  explicit RegionShares(const Basis& basis);

  // V, metres, of as many errors as there are regions: the root of the mean of their squares, by shares. 0 where
  // nothing was learned.
  std::vector<float> carry(const std::vector<double>& region_mm) const;

 private:
  struct BlockShare {
    std::uint32_t region;
    std::array<float, kBlockSize> lanes;  // of a vertex, over all regions: 1, or 0 where nothing was learned
  };
  std::size_t vertex_count_ = 0;
  std::vector<std::size_t> begin_ = {0};  // blocks + 1, into shares_
  std::vector<BlockShare> shares_;
};

}  // namespace bodyopt
