#include "trainer/train/pack/byte_allocation.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bodyopt {

using Eigen::Index;

ByteAllocation::ByteAllocation(const ResidualModel& model) {
  const std::vector<Index> frames = heldout_frames(model);
  for (const RegionModel& region : model.regions) {
    std::vector<Candidate>& candidates = regions_.emplace_back();
    for (const Regression& fit : region.fits) candidates.push_back(candidate(region, fit, frames));
    vertex_motion_ += region.components.energy.mean() / model.vertices;
  }
}

ByteAllocation::Candidate ByteAllocation::candidate(const RegionModel& region, const Regression& fit,
                                                    const std::vector<Index>& frames) {
  const Eigen::MatrixXd& basis = region.components.basis;
  const Eigen::RowVectorXd motion =
      region.components.coefficients(frames, Eigen::all).colwise().squaredNorm() / static_cast<double>(frames.size());
  const Eigen::RowVectorXd saved = motion - fit.errors.colwise().squaredNorm() / static_cast<double>(frames.size());
  const auto features = static_cast<double>(region.features.size());
  const auto coordinates = static_cast<double>(region.projection.rows());
  const auto centres = static_cast<double>(fit.centres.rows());
  constexpr double kWord = 4;
  Candidate result;
  result.bytes = sizeof(Region) + kWord * (features + coordinates * (1 + std::ceil(features / 2)) +
                                           centres * (1 + std::ceil(coordinates / 2)));
  result.component_bytes = kWord * (2 + coordinates + centres);
  for (Index k = 0; k < basis.rows(); ++k) {
    std::vector<Entry>& entries = result.components.emplace_back();
    for (std::size_t v = 0; v < region.region.vertices.size(); ++v) {
      const std::uint32_t block = region.region.vertices[v] / kBlockSize;
      if (entries.empty() || entries.back().block != block) entries.push_back({block, 0, 0});
      entries.back().saved += saved[k] * basis.row(k).segment<3>(3 * static_cast<Index>(v)).squaredNorm();
    }
    const std::vector<BlockRounding> rounding = rounding_of(region, k);
    for (std::size_t e = 0; e < entries.size(); ++e) entries[e].fine_saved = motion[k] * rounding[e].left;
  }
  return result;
}

ByteAllocation::Bid ByteAllocation::bid(const Candidate& candidate, double per_byte) {
  const double entry_cost = per_byte * sizeof(BlendEntry);
  Bid bid{{}, -per_byte * candidate.bytes};
  bid.region.fine.resize(candidate.components.size());
  for (const std::vector<Entry>& entries : candidate.components) {
    std::vector<std::uint32_t>& blocks = bid.region.blocks.emplace_back();
    std::vector<std::uint32_t>& fine = bid.region.fine[bid.region.blocks.size() - 1];
    double gain = -per_byte * candidate.component_bytes;
    for (const Entry& entry : entries) {
      if (!(entry.saved > entry_cost)) continue;
      blocks.push_back(entry.block);
      gain += entry.saved - entry_cost;
      if (!(entry.fine_saved > entry_cost)) continue;
      fine.push_back(entry.block);
      gain += entry.fine_saved - entry_cost;
    }
    if (!(gain > 0)) {
      blocks.clear();
      fine.clear();
    }
    bid.gain += std::max(0.0, gain);
  }
  return bid;
}

Selection ByteAllocation::at(double price) const { return best(price, std::numeric_limits<std::size_t>::max()); }

Selection ByteAllocation::with_all_centres(double price) const { return best(price, 1); }

Selection ByteAllocation::best(double price, std::size_t most_fits) const {
  Selection selection;
  for (const std::vector<Candidate>& fits : regions_) {
    SelectedRegion& region = selection.emplace_back();
    double gain = 0;
    for (std::size_t f = 0; f < std::min(fits.size(), most_fits); ++f) {
      Bid offer = bid(fits[f], price * vertex_motion_);
      if (!(offer.gain > gain)) continue;
      gain = offer.gain;
      region = {f, std::move(offer.region.blocks), std::move(offer.region.fine)};
    }
  }
  return selection;
}

}  // namespace bodyopt
