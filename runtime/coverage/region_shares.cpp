#include "runtime/coverage/region_shares.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "runtime/core/half.h"

namespace bodyopt {
namespace {

using Lanes = std::array<double, kBlockSize>;

void add_squares(const BlendEntry& entry, Lanes& sums) {
  const double scale = double{half_low(entry.scale_coefficient)};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t lane = 0; lane < kBlockSize; ++lane) {
      const std::uint32_t word = entry.numbers[i * kLaneWords + lane / 4];
      sums[lane] += std::pow(scale * static_cast<std::int8_t>(word >> 8 * (lane % 4)), 2);
    }
  }
}

}  // namespace

RegionShares::RegionShares(const Basis& basis) : vertex_count_(basis.mesh.vertex_count()) {
  const ResidualTable& residual = basis.residual;
  for (std::size_t block = 0; block + 1 < residual.blend_begin.size(); ++block) {
    std::map<std::uint32_t, Lanes> squares;  // by region
    Lanes all{};
    for (std::uint32_t e = residual.blend_begin[block]; e < residual.blend_begin[block + 1]; ++e) {
      const BlendEntry& entry = residual.blend[e];
      add_squares(entry, squares[residual.coefficient_region[entry.scale_coefficient >> 16]]);
    }
    for (const auto& [region, lanes] : squares) {
      for (std::size_t lane = 0; lane < kBlockSize; ++lane) all[lane] += lanes[lane];
    }
    for (const auto& [region, lanes] : squares) {
      BlockShare& share = shares_.emplace_back(BlockShare{region, {}});
      for (std::size_t lane = 0; lane < kBlockSize; ++lane) {
        if (all[lane] > 0) share.lanes[lane] = static_cast<float>(lanes[lane] / all[lane]);
      }
    }
    begin_.push_back(shares_.size());
  }
}

std::vector<float> RegionShares::carry(const std::vector<double>& region_mm) const {
  std::vector<float> metres(vertex_count_);
  for (std::size_t block = 0; block + 1 < begin_.size(); ++block) {
    Lanes squares{};
    for (std::size_t s = begin_[block]; s < begin_[block + 1]; ++s) {
      const double mm = region_mm[shares_[s].region];
      for (std::size_t lane = 0; lane < kBlockSize; ++lane) squares[lane] += mm * mm * double{shares_[s].lanes[lane]};
    }
    const std::size_t first = block * kBlockSize, count = std::min<std::size_t>(kBlockSize, vertex_count_ - first);
    for (std::size_t lane = 0; lane < count; ++lane) {
      metres[first + lane] = static_cast<float>(1e-3 * std::sqrt(squares[lane]));
    }
  }
  return metres;
}

}  // namespace bodyopt
