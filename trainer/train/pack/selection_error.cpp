#include "trainer/train/pack/selection_error.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "base/spread_evenly.h"

namespace bodyopt {

using Eigen::Index;

namespace {

// A region in some frames: what is off where a component is kept, and where it is not.
struct SampledRegion {
  Eigen::MatrixXf kept, dropped;  // frames x K, metres
  Eigen::MatrixXf basis;
};

// 3 x kBlockSize columns: the displacements that are left of a block's vertices, a row per frame.
class BlockError {
 public:
  BlockError(std::uint32_t block, Index frames) : block_(block), left_(Eigen::MatrixXf::Zero(frames, 3 * kBlockSize)) {}

  void add(const RegionModel& model, const SampledRegion& sampled, const SelectedRegion& selected) {
    const std::vector<std::uint32_t>& vertices = model.region.vertices;
    const auto begin = std::lower_bound(vertices.begin(), vertices.end(), block_ * kBlockSize);
    const auto end = std::lower_bound(begin, vertices.end(), (block_ + 1) * kBlockSize);
    if (begin == end) return;
    Eigen::MatrixXf off = sampled.dropped;
    for (std::size_t k = 0; k < selected.blocks.size(); ++k) {
      const std::vector<std::uint32_t>& blocks = selected.blocks[k];
      const auto column = static_cast<Index>(k);
      if (std::binary_search(blocks.begin(), blocks.end(), block_)) off.col(column) = sampled.kept.col(column);
    }
    const Eigen::MatrixXf moved = off * sampled.basis.middleCols(3 * (begin - vertices.begin()), 3 * (end - begin));
    for (auto v = begin; v != end; ++v)
      left_.middleCols<3>(3 * Index{*v % kBlockSize}) += moved.middleCols<3>(3 * (v - begin));
  }

  double energy() const { return left_.cast<double>().squaredNorm(); }

 private:
  std::uint32_t block_;
  Eigen::MatrixXf left_;
};

}  // namespace

double expected_error(const ResidualModel& model, const Selection& selection) {
  constexpr std::size_t kMostFrames = 400;
  const std::vector<Index> heldout = heldout_frames(model);
  std::vector<Index> frames;
  for (const std::size_t n : spread_evenly(heldout.size(), kMostFrames)) frames.push_back(heldout[n]);
  std::vector<SampledRegion> sampled;
  double beyond = 0;  // square metres, what no component has
  for (std::size_t r = 0; r < model.regions.size(); ++r) {
    const RegionModel& region = model.regions[r];
    const Components& components = region.components;
    sampled.push_back({region.fits[selection[r].fit].errors(frames, Eigen::all).cast<float>(),
                       -components.coefficients(frames, Eigen::all).cast<float>(), components.basis.cast<float>()});
    beyond += components.truncated.mean();
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

std::vector<double> frame_energies(const RegionModel& region, const SelectedRegion& selected) {
  const Components& components = region.components;
  const Eigen::MatrixXd& errors = region.fits[selected.fit].errors;
  std::vector<double> energies(components.truncated.begin(), components.truncated.end());
  for (std::size_t k = 0; k < selected.blocks.size(); ++k) {
    const auto column = static_cast<Index>(k);
    double kept = 0, dropped = 0;  // squared lengths of the component's vectors, weighted by the region
    for (std::size_t v = 0; v < region.region.vertices.size(); ++v) {
      const std::vector<std::uint32_t>& blocks = selected.blocks[k];
      const bool is_kept = std::binary_search(blocks.begin(), blocks.end(), region.region.vertices[v] / kBlockSize);
      const auto vector = components.basis.row(column).segment<3>(3 * static_cast<Index>(v));
      (is_kept ? kept : dropped) += vector.squaredNorm() / region.region.weights[v];
    }
    for (std::size_t n = 0; n < energies.size(); ++n) {
      const double error = errors(static_cast<Index>(n), column);
      const double motion = components.coefficients(static_cast<Index>(n), column);
      energies[n] += kept * error * error + dropped * motion * motion;
    }
  }
  return energies;
}

}  // namespace bodyopt
