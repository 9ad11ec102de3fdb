#include "trainer/train/residual.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "runtime/cpu/half.h"
#include "runtime/rig.h"
#include "trainer/parallel.h"
#include "trainer/progress.h"
#include "trainer/train/mesh_table.h"
#include "trainer/train/select_features.h"
#include "trainer/train/strain.h"

namespace bodyopt {
namespace {

using Eigen::Index;

// Radii within which a region sees features, as parts of the character's longest extent.
constexpr double kRadii[] = {0.06, 0.12, 0.2, 0.35};
// Features of a region at most, where there are kernels: more cost bytes and time and teach it nothing (measured from
// 32 to 400).
constexpr std::size_t kMostFeatures = 40, kMostFeaturesOfAll = 200;  // of a region that is the whole skin
// A region may do with all centres that it may have, a half or a quarter of them.
constexpr int kCentreFractions[] = {1, 2, 4};
// Cross-validation: blocks of consecutive frames, dealt to folds.
constexpr int kFolds = 5, kLongestRun = 20;
constexpr std::uint32_t kMostCoefficients = 65536;

// Consecutive regions and all vertices of theirs and beside them, ascending.
struct SkinPart {
  std::size_t begin, end;
  std::vector<std::uint32_t> vertices;
};

// As few parts as leave half the memory free while the displacements of one are in it.
std::vector<SkinPart> parts_that_fit(const std::vector<RegionWeights>& regions, const UnposedShapes& shapes,
                                     std::size_t frames, double memory_gib) {
  const double most = 0.5 * memory_gib * 0x1p30 / (3 * sizeof(float) * static_cast<double>(frames));
  std::vector<SkinPart> parts;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const std::vector<std::uint32_t> vertices = shapes.with_neighbours(regions[r].vertices);
    std::vector<std::uint32_t> with_last;
    if (!parts.empty()) {
      const std::vector<std::uint32_t>& last = parts.back().vertices;
      std::set_union(last.begin(), last.end(), vertices.begin(), vertices.end(), std::back_inserter(with_last));
    }
    if (parts.empty() || static_cast<double>(with_last.size()) > most) {
      parts.push_back({r, r + 1, vertices});
    } else {
      parts.back() = {parts.back().begin, r + 1, std::move(with_last)};
    }
  }
  return parts;
}

// The region with its vertices numbered as in the part.
RegionWeights within(const SkinPart& part, RegionWeights region) {
  for (std::uint32_t& vertex : region.vertices) {
    const auto place = std::lower_bound(part.vertices.begin(), part.vertices.end(), vertex);
    vertex = static_cast<std::uint32_t>(place - part.vertices.begin());
  }
  return region;
}

// Basis columns with a largest entry of 1 suit the scales of the blend table, which are halves; the coefficients keep
// the metres.
void normalise(RegionModel& model) {
  Components& components = model.components;
  for (Index k = 0; k < components.basis.rows(); ++k) {
    const double largest = components.basis.row(k).cwiseAbs().maxCoeff();
    if (!(largest > 0)) continue;
    components.basis.row(k) /= largest;
    components.coefficients.col(k) *= largest;
    for (Regression& fit : model.fits) {
      fit.weights.col(k) *= largest;
      fit.errors.col(k) *= largest;
    }
  }
}

std::vector<std::vector<std::uint32_t>> feature_choices(const Character& character, const RegionWeights& region,
                                                        const std::vector<FeatureGroup>& groups, const Method& method) {
  std::vector<std::vector<std::uint32_t>> choices;
  if (method.support != Method::Support::whole_skin) {
    for (const double radius : kRadii) {
      choices.push_back(region_features(character, region, groups, radius * longest_extent(character.vertices)));
    }
  }
  // A linear map may well see everything: it has little to get wrong with.
  if (choices.empty() || !method.kernels) {
    std::vector<std::uint32_t>& all = choices.emplace_back();
    for (const FeatureGroup& group : groups) all.insert(all.end(), group.features.begin(), group.features.end());
  }
  choices.erase(std::unique(choices.begin(), choices.end()), choices.end());
  return choices;
}

std::size_t most_features(const Method& method) {
  if (!method.kernels) return std::numeric_limits<std::size_t>::max();
  return method.support == Method::Support::whole_skin ? kMostFeaturesOfAll : kMostFeatures;
}

// The features that tell most, ascending, and what each explains.
void choose_features(const FeatureSamples& samples, const std::vector<std::uint32_t>& choice, std::size_t most,
                     RegionModel& model) {
  const std::vector<Index> columns(choice.begin(), choice.end());
  const Eigen::MatrixXd values =
      samples.values(Eigen::all, columns).rowwise() - Eigen::RowVectorXd(samples.rest(columns));
  const Eigen::MatrixXd& targets = model.components.coefficients;
  std::vector<SelectedFeature> selected = select_features(values, targets, most);
  std::sort(selected.begin(), selected.end(),
            [](const SelectedFeature& a, const SelectedFeature& b) { return a.column < b.column; });
  model.features.clear();
  model.worth.clear();
  for (const SelectedFeature& feature : selected) {
    model.features.push_back(choice[feature.column]);
    model.worth.push_back(feature.gain * targets.squaredNorm());
  }
}

// Features and regression are chosen before the columns are scaled: until then the error of a coefficient is the error
// of positions, weighted by the region.
RegionModel fit_region(const RegionWeights& region, const SkinPart& part,
                       const std::vector<std::vector<std::uint32_t>>& choices, const FeatureSamples& features,
                       const Displacements& displacements, const std::vector<int>& folds, const TrainOptions& options) {
  RegionModel model;
  model.region = region;
  model.components = principal_components(displacements, within(part, region), options.components, options.seed);
  const int centres = options.method.kernels ? options.centres : 0;
  double least = std::numeric_limits<double>::infinity();
  std::vector<std::uint32_t> best;
  std::vector<double> worth;
  for (const std::vector<std::uint32_t>& choice : choices) {
    choose_features(features, choice, most_features(options.method), model);
    const double error = trial_error(regression_data(features, model, folds), centres);
    if (!(error < least)) continue;
    least = error;
    best = model.features;
    worth = model.worth;
  }
  model.features = best;
  model.worth = worth;
  const RegressionData chosen = regression_data(features, model, folds);
  for (const int fraction : kCentreFractions) {
    model.fits.push_back(fit_regression(chosen, centres / fraction));
    if (centres == 0) break;
  }
  normalise(model);
  return model;
}

}  // namespace

RegressionData regression_data(const FeatureSamples& features, const RegionModel& region,
                               const std::vector<int>& folds) {
  RegressionData data;
  const std::vector<Index> columns(region.features.begin(), region.features.end());
  data.features = features.values(Eigen::all, columns);
  data.rest = features.rest(columns);
  data.targets = region.components.coefficients;
  data.folds = folds;
  return data;
}

std::vector<Index> heldout_frames(const ResidualModel& model) {
  std::vector<Index> frames;
  for (std::size_t n = 0; n < model.folds.size(); ++n) {
    if (model.folds[n] >= 0) frames.push_back(static_cast<Index>(n));
  }
  return frames;
}

ResidualModel fit_residual(const Character& character, UnposedShapes& shapes, const std::vector<RegionWeights>& regions,
                           const std::vector<FeatureGroup>& groups, const FeatureSamples& features,
                           const std::vector<int>& takes, const TrainOptions& options) {
  const int run = std::clamp(static_cast<int>(takes.size()) / (2 * kFolds), 2, kLongestRun);
  ResidualModel model;
  model.folds = blocked_folds(takes, run, kFolds);
  model.ranges = features.ranges;
  model.vertices = shapes.vertex_count();
  model.regions.resize(regions.size());
  const std::vector<FramePair> pairs = frames_of_one_pose(features.values);
  const double size = longest_extent(character.vertices);
  const std::vector<std::size_t> frames = spread_evenly(takes.size(), takes.size());
  const std::vector<SkinPart> parts = parts_that_fit(regions, shapes, frames.size(), options.memory_gib);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const SkinPart& part = parts[p];
    const std::string which =
        parts.size() > 1 ? ", part " + std::to_string(p + 1) + " of " + std::to_string(parts.size()) : "";
    const Displacements displacements = shapes("train: un-posing" + which, frames, part.vertices);
    Progress progress("train: regions" + which, part.end - part.begin);
    parallel_for(part.end - part.begin, [&](std::size_t k) {
      const std::size_t r = part.begin + k;
      const auto choices = feature_choices(character, regions[r], groups, options.method);
      model.regions[r] = fit_region(regions[r], part, choices, features, displacements, model.folds, options);
      model.regions[r].contradictions = contradictions(pairs, displacements, within(part, regions[r]), size);
      progress.advance();
    });
  }
  return model;
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

namespace {

// A column's vectors at the lanes of a block.
using BlockVectors = Eigen::Matrix<double, 3, kBlockSize>;

// Half whose numbers reach 127 at the largest component. Not a subnormal one, which a device may read as 0.
std::uint32_t blend_scale(double largest) {
  const double scale = largest / (127 * double{kBlendFraction});
  return std::max(kSmallestNormalHalf, half_from_float(static_cast<float>(scale)));
}

// Numbers are rounded with the scale as it is stored. Its own rounding, 2^-11 at most, cannot lift them to 127.5.
BlendEntry pack_entry(const BlockVectors& vectors, std::uint32_t coefficient) {
  const std::uint32_t scale = blend_scale(vectors.cwiseAbs().maxCoeff());
  const double step = double{float_from_half(scale)} * double{kBlendFraction};
  BlendEntry entry{scale | coefficient << 16, {}};
  for (std::uint32_t k = 0; k < 3 * kBlockSize; ++k) {
    const double number = std::nearbyint(vectors(k / kBlockSize, k % kBlockSize) / step);
    entry.numbers[k / 4] |= (static_cast<std::uint32_t>(static_cast<int>(number)) & 0xffu) << 8 * (k % 4);
  }
  return entry;
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
  }

  PackedResidual take() { return {std::move(table_), std::move(regions_)}; }

 private:
  // Whether anything of the region is kept.
  bool add(const RegionModel& model, const SelectedRegion& selected) {
    const std::vector<Index> kept = add_columns(model, selected.blocks);
    if (kept.empty()) return false;
    const Regression& regression = model.fits[selected.fit];
    const auto count = [](std::size_t size) { return static_cast<std::uint32_t>(size); };
    Region region;
    region.feature_begin = count(table_.region_features.size());
    region.feature_count = count(model.features.size());
    region.centre_begin = table_.centre_count();
    region.centre_count = count(static_cast<std::size_t>(regression.centres.rows()));
    region.centre_values = count(table_.centres.size());
    region.coefficient_begin = table_.coefficient_count();
    region.coefficient_count = count(kept.size());
    region.weight_values = count(table_.weights.size());
    region.inverse_width2 = static_cast<float>(regression.inverse_width2);

    const std::uint32_t number = count(table_.regions.size());
    table_.region_features.insert(table_.region_features.end(), model.features.begin(), model.features.end());
    table_.centre_region.insert(table_.centre_region.end(), region.centre_count, number);
    table_.coefficient_region.insert(table_.coefficient_region.end(), kept.size(), number);
    for (Index m = 0; m < regression.centres.rows(); ++m) add_centre(regression.centres.row(m));
    for (const Index k : kept) {
      table_.weights.push_back(0.0f);  // nothing is added at rest
      for (Index f = 0; f < regression.weights.rows(); ++f) {
        table_.weights.push_back(static_cast<float>(regression.weights(f, k)));
      }
    }
    table_.regions.push_back(region);
    return true;
  }

  // The regression's centres are halves already: nothing is lost.
  void add_centre(const Eigen::RowVectorXd& centre) {
    const auto half = [&](Index k) { return k < centre.size() ? half_from_float(static_cast<float>(centre[k])) : 0u; };
    for (Index k = 0; k < centre.size(); k += 2) table_.centres.push_back(half(k) | half(k + 1) << 16);
  }

  // Blend entries of the region's components, and which components have any.
  std::vector<Index> add_columns(const RegionModel& model, const std::vector<std::vector<std::uint32_t>>& blocks) {
    std::vector<Index> kept;
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      const std::uint32_t coefficient = table_.coefficient_count() + static_cast<std::uint32_t>(kept.size());
      if (blocks[k].empty() || coefficient >= kMostCoefficients) continue;
      kept.push_back(static_cast<Index>(k));
      for (const std::uint32_t block : blocks[k]) {
        blend_[block].push_back(pack_entry(vectors_in(block, model, kept.back()), coefficient));
      }
    }
    return kept;
  }

  static BlockVectors vectors_in(std::uint32_t block, const RegionModel& model, Index component) {
    const std::vector<std::uint32_t>& vertices = model.region.vertices;
    const auto first = std::lower_bound(vertices.begin(), vertices.end(), block * kBlockSize);
    BlockVectors vectors = BlockVectors::Zero();
    for (auto v = first; v != vertices.end() && *v / kBlockSize == block; ++v) {
      vectors.col(*v % kBlockSize) =
          model.components.basis.row(component).segment<3>(3 * (v - vertices.begin())).transpose();
    }
    return vectors;
  }

  std::vector<std::vector<BlendEntry>> blend_;
  ResidualTable table_;
  std::vector<std::size_t> regions_;
};

}  // namespace

PackedResidual pack_residual(const ResidualModel& model, const Selection& selection) {
  return Packer(model, selection).take();
}

}  // namespace bodyopt
