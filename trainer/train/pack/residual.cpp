#include "trainer/train/pack/residual.h"

#include <algorithm>
#include <cmath>

#include "base/rows_where.h"
#include "runtime/core/half.h"

namespace bodyopt::trainer {
namespace {

// Half whose numbers reach 127 at the largest component. Not a subnormal one, which a device may read as 0.
std::uint32_t blend_scale(double largest) {
  const double scale = largest / (127 * double{kBlendFraction});
  return std::max(kSmallestNormalHalf, half_from_float(static_cast<float>(scale)));
}

using Eigen::Index;

constexpr std::uint32_t kMostCoefficients = 65536;

// The fade table of some regions.
FadeTable fade_of(const FadeTable& table, const std::vector<std::size_t>& regions) {
  if (table.empty()) return {};
  FadeTable some = table;
  some.region_begin = {0};
  some.region_joints.clear();
  some.region_weights.clear();
  for (const std::size_t r : regions) {
    for (std::uint32_t k = table.region_begin[r]; k < table.region_begin[r + 1]; ++k) {
      some.region_joints.push_back(table.region_joints[k]);
      some.region_weights.push_back(table.region_weights[k]);
    }
    some.region_begin.push_back(static_cast<std::uint32_t>(some.region_joints.size()));
  }
  return some;
}

BlockVectors vectors_in(std::uint32_t block, const RegionModel& model, Index component) {
  const std::vector<std::uint32_t>& vertices = model.region.vertices;
  const auto first = std::lower_bound(vertices.begin(), vertices.end(), block * kBlockSize);
  BlockVectors vectors = BlockVectors::Zero();
  for (auto v = first; v != vertices.end() && *v / kBlockSize == block; ++v) {
    vectors.col(*v % kBlockSize) =
        model.components.basis.row(component).segment<3>(3 * (v - vertices.begin())).transpose();
  }
  return vectors;
}

class Packer {
 public:
  Packer(const ResidualModel& model, const Selection& selection)
      : blend_((model.vertices + kBlockSize - 1) / kBlockSize) {
    table_.controls = model.controls;
    table_.features = model.ranges;
    for (std::size_t r = 0; r < model.regions.size(); ++r) {
      if (add(model.regions[r], selection[r])) regions_.push_back(r);
    }
    table_.blend_begin = {0};
    for (const std::vector<BlendEntry>& entries : blend_) {
      table_.blend.insert(table_.blend.end(), entries.begin(), entries.end());
      table_.blend_begin.push_back(static_cast<std::uint32_t>(table_.blend.size()));
    }
    if (!regions_.empty()) table_.fade = fade_of(model.fade, regions_);
  }

  PackedResidual take() { return {std::move(table_), std::move(regions_)}; }

 private:
  // Whether anything of the region is kept.
  bool add(const RegionModel& model, const SelectedRegion& selected) {
    const std::vector<Index> kept = add_columns(model, selected);
    if (kept.empty()) return false;
    const Regression& regression = model.fits[selected.fit];
    const auto count = [](std::size_t size) { return static_cast<std::uint32_t>(size); };
    Region region;
    region.feature_begin = count(table_.region_features.size());
    region.feature_count = count(model.features.size());
    region.coordinate_begin = table_.coordinate_count();
    region.coordinate_count = count(static_cast<std::size_t>(model.projection.rows()));
    region.projection_values = count(table_.projections.size());
    region.centre_begin = table_.centre_count();
    region.centre_count = count(static_cast<std::size_t>(regression.centres.rows()));
    region.centre_values = count(table_.centres.size());
    region.coefficient_begin = table_.coefficient_count();
    region.coefficient_count = count(kept.size());
    region.weight_values = count(table_.weights.size());
    region.inverse_width2 = static_cast<float>(regression.inverse_width2);

    const std::uint32_t number = count(table_.regions.size());
    table_.region_features.insert(table_.region_features.end(), model.features.begin(), model.features.end());
    table_.coordinate_region.insert(table_.coordinate_region.end(), region.coordinate_count, number);
    table_.centre_region.insert(table_.centre_region.end(), region.centre_count, number);
    table_.coefficient_region.insert(table_.coefficient_region.end(), kept.size(), number);
    add_halves(model.projection, table_.projections);
    add_halves(regression.centres, table_.centres);
    for (const Index k : kept) {
      table_.weights.push_back(0.0f);  // nothing is added at rest
      for (Index f = 0; f < regression.weights.rows(); ++f) {
        table_.weights.push_back(static_cast<float>(regression.weights(f, k)));
      }
    }
    table_.regions.push_back(region);
    return true;
  }

  // Row by row, two a word. The numbers are halves already: nothing is lost.
  static void add_halves(const Eigen::MatrixXd& rows, std::vector<std::uint32_t>& words) {
    for (Index m = 0; m < rows.rows(); ++m) {
      const auto half = [&](Index k) { return k < rows.cols() ? half_from_float(static_cast<float>(rows(m, k))) : 0u; };
      for (Index k = 0; k < rows.cols(); k += 2) words.push_back(half(k) | half(k + 1) << 16);
    }
  }

  // Blend entries of the region's components, and which components have any.
  std::vector<Index> add_columns(const RegionModel& model, const SelectedRegion& selected) {
    const std::vector<std::vector<std::uint32_t>>& blocks = selected.blocks;
    std::vector<Index> kept;
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      const std::uint32_t coefficient = table_.coefficient_count() + static_cast<std::uint32_t>(kept.size());
      if (blocks[k].empty() || coefficient >= kMostCoefficients) continue;
      kept.push_back(static_cast<Index>(k));
      for (const std::uint32_t block : blocks[k]) {
        const PackedEntry packed = pack_entry(vectors_in(block, model, kept.back()), coefficient);
        blend_[block].push_back(packed.entry);
        const bool fine = std::binary_search(selected.fine[k].begin(), selected.fine[k].end(), block);
        if (fine) blend_[block].push_back(pack_entry(packed.left, coefficient).entry);
      }
    }
    return kept;
  }

  std::vector<std::vector<BlendEntry>> blend_;
  ResidualTable table_;
  std::vector<std::size_t> regions_;
};

}  // namespace

// Numbers are rounded with the scale as it is stored. Its own rounding, 2^-11 at most, cannot lift them to 127.5.
PackedEntry pack_entry(const BlockVectors& vectors, std::uint32_t coefficient) {
  const std::uint32_t scale = blend_scale(vectors.cwiseAbs().maxCoeff());
  const double step = double{float_from_half(scale)} * double{kBlendFraction};
  PackedEntry packed{{scale | coefficient << 16, {}}, vectors};
  for (std::uint32_t k = 0; k < 3 * kBlockSize; ++k) {
    const std::uint32_t row = k / kBlockSize, lane = k % kBlockSize;
    const double number = std::nearbyint(vectors(row, lane) / step);
    packed.entry.numbers[k / 4] |= (static_cast<std::uint32_t>(static_cast<int>(number)) & 0xffu) << 8 * (k % 4);
    packed.left(row, lane) -= number * step;
  }
  return packed;
}

RegressionData regression_data(const FeatureSamples& features, const RegionModel& region, const std::vector<int>& folds,
                               const Eigen::VectorXd& weights) {
  RegressionData data;
  const std::vector<Index> columns(region.features.begin(), region.features.end());
  data.features = features.values(Eigen::all, columns) * region.projection.transpose();
  data.rest = features.rest(columns) * region.projection.transpose();
  data.targets = region.components.coefficients;
  data.weights = weights;
  data.folds = folds;
  return data;
}

std::vector<Index> heldout_frames(const ResidualModel& model) {
  return rows_where(model.folds, [](int fold) { return fold >= 0; });
}

void drop_unused_fibres(StrainTable& strain, ResidualTable& residual, std::uint32_t first) {
  std::vector<bool> used(residual.features.size(), false);
  for (const std::uint32_t feature : residual.region_features) used[feature] = true;
  std::vector<FeatureRange> features;
  std::vector<std::uint32_t> place(residual.features.size()), kept;
  const std::uint32_t end = first + strain.fibre_count();
  for (std::uint32_t f = 0; f < residual.feature_count(); ++f) {
    const bool fibre = f >= first && f < end;
    if (fibre && !used[f]) continue;
    place[f] = static_cast<std::uint32_t>(features.size());
    features.push_back(residual.features[f]);
    if (fibre) kept.push_back(f - first);
  }
  residual.features = std::move(features);
  for (std::uint32_t& feature : residual.region_features) feature = place[feature];
  strain = keep_fibres(strain, kept);
}

std::vector<BlockRounding> rounding_of(const RegionModel& region, Eigen::Index component) {
  std::vector<BlockRounding> rounding;
  for (const std::uint32_t vertex : region.region.vertices) {
    const std::uint32_t block = vertex / kBlockSize;
    if (!rounding.empty() && rounding.back().block == block) continue;
    rounding.push_back({block, pack_entry(vectors_in(block, region, component), 0).left.squaredNorm()});
  }
  return rounding;
}

PackedResidual pack_residual(const ResidualModel& model, const Selection& selection) {
  return Packer(model, selection).take();
}

}  // namespace bodyopt::trainer
