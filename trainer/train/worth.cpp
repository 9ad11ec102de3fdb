#include "trainer/train/worth.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "trainer/parallel.h"

namespace bodyopt {

using Eigen::Index;

Worth::Worth(const ResidualModel& model) {
  for (const RegionModel& region : model.regions) {
    std::vector<Candidate>& candidates = regions_.emplace_back();
    for (const RegionFit& fit : region.fits) {
      candidates.push_back(candidate(region, fit.regression, model.heldout_frames));
    }
    vertex_motion_ +=
        region.components.energy / (static_cast<double>(region.components.coefficients.rows()) * model.vertices);
  }
}

Worth::Candidate Worth::candidate(const RegionModel& region, const Regression& fit, const std::vector<Index>& frames) {
  const Eigen::MatrixXd& basis = region.components.basis;
  const Eigen::RowVectorXd saved = (region.components.coefficients(frames, Eigen::all).colwise().squaredNorm() -
                                    fit.errors.colwise().squaredNorm()) /
                                   static_cast<double>(frames.size());
  const auto features = static_cast<double>(region.features.size());
  const auto centres = static_cast<double>(fit.centres.rows());
  constexpr double kWord = 4;
  Candidate result;
  result.bytes = sizeof(Region) + kWord * (features + centres * (1 + std::ceil(features / 2)));
  result.component_bytes = kWord * (2 + features + centres);
  for (Index k = 0; k < basis.rows(); ++k) {
    std::vector<Entry>& entries = result.components.emplace_back();
    for (std::size_t v = 0; v < region.region.vertices.size(); ++v) {
      const std::uint32_t block = region.region.vertices[v] / kBlockSize;
      if (entries.empty() || entries.back().block != block) entries.push_back({block, 0});
      entries.back().saved += saved[k] * basis.row(k).segment<3>(3 * static_cast<Index>(v)).squaredNorm();
    }
  }
  return result;
}

Worth::Bid Worth::bid(const Candidate& candidate, double per_byte) {
  const double entry_cost = per_byte * sizeof(BlendEntry);
  Bid bid{{}, -per_byte * candidate.bytes};
  for (const std::vector<Entry>& entries : candidate.components) {
    std::vector<std::uint32_t>& blocks = bid.region.blocks.emplace_back();
    double gain = -per_byte * candidate.component_bytes;
    for (const Entry& entry : entries) {
      if (!(entry.saved > entry_cost)) continue;
      blocks.push_back(entry.block);
      gain += entry.saved - entry_cost;
    }
    if (!(gain > 0)) blocks.clear();
    bid.gain += std::max(0.0, gain);
  }
  return bid;
}

Selection Worth::at(double price) const {
  Selection selection;
  for (const std::vector<Candidate>& fits : regions_) {
    SelectedRegion& region = selection.emplace_back();
    double gain = 0;
    for (std::size_t f = 0; f < fits.size(); ++f) {
      Bid best = bid(fits[f], price * vertex_motion_);
      if (!(best.gain > gain)) continue;
      gain = best.gain;
      region = {f, std::move(best.region.blocks)};
    }
  }
  return selection;
}

double Worth::forgone(const Selection& selection, std::size_t region) const {
  const std::vector<std::vector<std::uint32_t>>& kept = selection[region].blocks;
  const std::vector<std::vector<Entry>>& components = regions_[region][selection[region].fit].components;
  double sum = 0;
  for (std::size_t k = 0; k < components.size(); ++k) {
    for (const Entry& entry : components[k]) {
      if (k < kept.size() && std::binary_search(kept[k].begin(), kept[k].end(), entry.block)) continue;
      sum += std::max(0.0, entry.saved);
    }
  }
  return sum;
}

namespace {

// A region in some frames: what is off where a component is kept, and where it is not.
struct SampledRegion {
  Eigen::MatrixXd kept, dropped;  // frames x K, metres
};

// 3 x kBlockSize columns: the displacements that are left of a block's vertices, a row per frame.
class BlockError {
 public:
  BlockError(std::uint32_t block, Index frames) : block_(block), left_(Eigen::MatrixXd::Zero(frames, 3 * kBlockSize)) {}

  void add(const RegionModel& model, const SampledRegion& sampled, const SelectedRegion& selected) {
    const std::vector<std::uint32_t>& vertices = model.region.vertices;
    const auto begin = std::lower_bound(vertices.begin(), vertices.end(), block_ * kBlockSize);
    const auto end = std::lower_bound(begin, vertices.end(), (block_ + 1) * kBlockSize);
    if (begin == end) return;
    Eigen::MatrixXd off = sampled.dropped;
    for (std::size_t k = 0; k < selected.blocks.size(); ++k) {
      const std::vector<std::uint32_t>& blocks = selected.blocks[k];
      const auto column = static_cast<Index>(k);
      if (std::binary_search(blocks.begin(), blocks.end(), block_)) off.col(column) = sampled.kept.col(column);
    }
    const Eigen::MatrixXd moved =
        off * model.components.basis.middleCols(3 * (begin - vertices.begin()), 3 * (end - begin));
    for (auto v = begin; v != end; ++v)
      left_.middleCols<3>(3 * Index{*v % kBlockSize}) += moved.middleCols<3>(3 * (v - begin));
  }

  double energy() const { return left_.squaredNorm(); }

 private:
  std::uint32_t block_;
  Eigen::MatrixXd left_;
};

}  // namespace

double expected_error(const ResidualModel& model, const Selection& selection) {
  constexpr std::size_t kMostFrames = 400;
  std::vector<Index> frames;
  for (const std::size_t n : spread_evenly(model.heldout_frames.size(), kMostFrames))
    frames.push_back(model.heldout_frames[n]);
  std::vector<SampledRegion> sampled;
  double beyond = 0;  // square metres, what no component has
  for (std::size_t r = 0; r < model.regions.size(); ++r) {
    const RegionModel& region = model.regions[r];
    const Components& components = region.components;
    sampled.push_back({region.fits[selection[r].fit].regression.errors(frames, Eigen::all),
                       -components.coefficients(frames, Eigen::all)});
    beyond += components.truncated / static_cast<double>(components.coefficients.rows());
  }
  std::vector<double> energies((model.vertices + kBlockSize - 1) / kBlockSize);
  parallel_for(energies.size(), [&](std::size_t b) {
    BlockError error(static_cast<std::uint32_t>(b), static_cast<Index>(frames.size()));
    for (std::size_t r = 0; r < sampled.size(); ++r) error.add(model.regions[r], sampled[r], selection[r]);
    energies[b] = error.energy();
  });
  const double energy = std::accumulate(energies.begin(), energies.end(), 0.0) / static_cast<double>(frames.size());
  return std::sqrt((energy + beyond) / model.vertices);
}

}  // namespace bodyopt
