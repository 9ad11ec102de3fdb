#include "trainer/train/residual.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/cpu/half.h"
#include "runtime/rig.h"
#include "trainer/progress.h"
#include "trainer/train/mesh_table.h"
#include "trainer/train/parallel.h"

namespace bodyopt {
namespace {

using Eigen::Index;

// Radii within which a region sees features, as parts of the character's longest extent.
constexpr double kRadii[] = {0.06, 0.12, 0.2, 0.35};
// Cross-validation: blocks of consecutive frames, dealt to folds.
constexpr int kFolds = 5, kLongestRun = 20;
constexpr std::uint32_t kMostCoefficients = 65536;

// Basis columns with a largest entry of 1 fill the halves' range evenly; the coefficients keep the metres.
void normalise(RegionModel& model) {
  Components& components = model.components;
  for (Index k = 0; k < components.basis.rows(); ++k) {
    const double largest = components.basis.row(k).cwiseAbs().maxCoeff();
    if (!(largest > 0)) continue;
    components.basis.row(k) /= largest;
    components.coefficients.col(k) *= largest;
    model.regression.weights.col(k) *= largest;
  }
}

RegressionData regression_data(const FeatureSamples& samples, const std::vector<std::uint32_t>& features,
                               const Eigen::MatrixXd& targets, const std::vector<int>& folds) {
  RegressionData data;
  const std::vector<Index> columns(features.begin(), features.end());
  data.features = samples.values(Eigen::all, columns);
  data.rest = samples.rest(columns);
  data.targets = targets;
  data.folds = folds;
  return data;
}

std::vector<std::vector<std::uint32_t>> feature_choices(const Character& character, const RegionWeights& region,
                                                        const std::vector<FeatureGroup>& groups,
                                                        const TrainOptions& options) {
  std::vector<std::vector<std::uint32_t>> choices;
  if (options.joint_only_linear) {
    std::vector<std::uint32_t>& all = choices.emplace_back();
    for (const FeatureGroup& group : groups) all.insert(all.end(), group.features.begin(), group.features.end());
    return choices;
  }
  for (const double radius : kRadii) {
    choices.push_back(region_features(character, region, groups, radius * longest_extent(character.vertices)));
  }
  choices.erase(std::unique(choices.begin(), choices.end()), choices.end());
  return choices;
}

// Features and regression are chosen before the columns are scaled: until then the error of a coefficient is the error
// of positions, weighted by the region.
RegionModel fit_region(const RegionWeights& region, const std::vector<std::vector<std::uint32_t>>& choices,
                       const FeatureSamples& features, const Displacements& displacements,
                       const std::vector<int>& folds, const TrainOptions& options) {
  RegionModel model;
  model.region = region;
  model.components = principal_components(displacements, region, options.components);
  const int centres = options.joint_only_linear ? 0 : options.centres;
  const auto data_of = [&](const std::vector<std::uint32_t>& choice) {
    return regression_data(features, choice, model.components.coefficients, folds);
  };
  double least = std::numeric_limits<double>::infinity();
  for (const std::vector<std::uint32_t>& choice : choices) {
    const double error = choices.size() > 1 ? trial_error(data_of(choice), centres) : 0;
    if (!(error < least)) continue;
    least = error;
    model.features = choice;
  }
  model.regression = fit_regression(data_of(model.features), centres);
  normalise(model);
  return model;
}

}  // namespace

ResidualModel fit_residual(const Character& character, const Basis& basis, const std::vector<RegionWeights>& regions,
                           const std::vector<FeatureGroup>& groups, const FeatureSamples& features,
                           const Displacements& displacements, const std::vector<int>& takes,
                           const TrainOptions& options) {
  const int run = std::clamp(static_cast<int>(takes.size()) / (2 * kFolds), 2, kLongestRun);
  const std::vector<int> folds = blocked_folds(takes, run, kFolds);
  ResidualModel model;
  model.ranges = features.ranges;
  model.vertices = basis.mesh.vertex_count();
  model.regions.resize(regions.size());
  Progress progress("train: regions", regions.size());
  parallel_for(regions.size(), [&](std::size_t r) {
    const auto choices = feature_choices(character, regions[r], groups, options);
    model.regions[r] = fit_region(regions[r], choices, features, displacements, folds, options);
    progress.advance();
  });
  return model;
}

namespace {

double root_mean_square(const Eigen::VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

// A column's vectors at the lanes of a block.
using BlockVectors = Eigen::Matrix<double, 3, kBlockSize>;

// Half whose numbers reach 127 at the largest component. Not a subnormal one, which a device may read as 0.
std::uint32_t blend_scale(double largest) {
  constexpr std::uint32_t kSmallestNormal = 0x0400;
  const double scale = largest / (127 * double{kBlendFraction});
  return std::max(kSmallestNormal, half_from_float(static_cast<float>(scale)));
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
  Packer(const ResidualModel& model, int components, double negligible)
      : components_(components), negligible_(negligible), blend_((model.vertices + kBlockSize - 1) / kBlockSize) {
    table_.controls = model.controls;
    table_.features = model.ranges;
    for (const RegionModel& region : model.regions) add(region);
    table_.blend_begin = {0};
    for (const std::vector<BlendEntry>& entries : blend_) {
      table_.blend.insert(table_.blend.end(), entries.begin(), entries.end());
      table_.blend_begin.push_back(static_cast<std::uint32_t>(table_.blend.size()));
    }
  }

  ResidualTable take() { return std::move(table_); }

 private:
  void add(const RegionModel& model) {
    const std::vector<Index> kept = add_columns(model);
    if (kept.empty()) return;
    const Regression& regression = model.regression;
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
    for (Index m = 0; m < regression.centres.rows(); ++m) {
      for (Index k = 0; k < regression.centres.cols(); ++k) {
        table_.centres.push_back(static_cast<float>(regression.centres(m, k)));
      }
    }
    for (const Index k : kept) {
      table_.weights.push_back(0.0f);  // nothing is added at rest
      for (Index f = 0; f < regression.weights.rows(); ++f) {
        table_.weights.push_back(static_cast<float>(regression.weights(f, k)));
      }
    }
    table_.regions.push_back(region);
  }

  // Blend entries of the region's components, and which components have any.
  std::vector<Index> add_columns(const RegionModel& model) {
    std::vector<Index> kept;
    const Components& components = model.components;
    const Index most = std::min<Index>(components_, components.basis.rows());
    for (Index k = 0; k < most; ++k) {
      const std::uint32_t coefficient = table_.coefficient_count() + static_cast<std::uint32_t>(kept.size());
      if (coefficient >= kMostCoefficients) break;
      const double size = root_mean_square(components.coefficients.col(k));
      if (add_column(model.region.vertices, components.basis.row(k), size, coefficient)) kept.push_back(k);
    }
    return kept;
  }

  // Blend entries of one column in every block where it moves a vertex by more than what is negligible. `size`: of its
  // coefficient, metres. False when there are none.
  bool add_column(const std::vector<std::uint32_t>& vertices, const Eigen::RowVectorXd& column, double size,
                  std::uint32_t coefficient) {
    bool any = false;
    for (std::size_t next = 0; next < vertices.size();) {
      const std::uint32_t block = vertices[next] / kBlockSize;
      BlockVectors vectors = BlockVectors::Zero();
      for (; next < vertices.size() && vertices[next] / kBlockSize == block; ++next) {
        vectors.col(vertices[next] % kBlockSize) = column.segment<3>(3 * static_cast<Index>(next)).transpose();
      }
      if (!(size * vectors.colwise().norm().maxCoeff() > negligible_)) continue;
      blend_[block].push_back(pack_entry(vectors, coefficient));
      any = true;
    }
    return any;
  }

  int components_;
  double negligible_;
  std::vector<std::vector<BlendEntry>> blend_;
  ResidualTable table_;
};

}  // namespace

ResidualTable pack_residual(const ResidualModel& model, int components, double negligible) {
  return Packer(model, components, negligible).take();
}

}  // namespace bodyopt
