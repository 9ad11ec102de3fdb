#include "trainer/train/fit/fade.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>

#include "base/parallel.h"
#include "base/rows_where.h"
#include "runtime/host/fade.h"
#include "runtime/host/rig.h"
#include "trainer/train/features/features.h"
#include "trainer/train/regression/components.h"

namespace bodyopt::trainer {
namespace {

constexpr double kSkinShare = 0.3;    // in what a region minds; the rest is what its features explain
constexpr double kLeastTurn = 0.05;   // radians, root mean square: less counts as this
constexpr double kNegligible = 0.03;  // share of a joint

using Shares = Eigen::VectorXd;  // per joint, as feature_joints()

void scale_to_one(Shares& shares) {
  const double sum = shares.sum();
  if (sum > 0) shares /= sum;
}

// Knows which joints a feature is of.
class FeatureJoints {
 public:
  FeatureJoints(const Basis& basis, const std::vector<Muscle>& muscles)
      : joints_(feature_joints(basis.skeleton)), first_strain_(9 * joints_.size()) {
    for (const Muscle& muscle : muscles) spans_.push_back(places(spanned_joints(basis.skeleton, muscle)));
    for (const std::size_t muscle : fibre_muscles(basis.strain, muscles)) muscle_of_fibre_.push_back(muscle);
  }

  std::size_t count() const { return joints_.size(); }

  // One joint, those that a fibre's muscle acts across, or of a control none.
  std::vector<std::size_t> of(std::uint32_t feature) const {
    if (feature < first_strain_) return {feature / 9};
    const std::size_t fibre = feature - first_strain_;
    return fibre < muscle_of_fibre_.size() ? spans_[muscle_of_fibre_[fibre]] : std::vector<std::size_t>{};
  }

  // The places of those of the skeleton's joints that have features.
  std::vector<std::size_t> places(const std::vector<std::uint32_t>& joints) const {
    std::vector<std::size_t> found;
    for (const std::uint32_t joint : joints) {
      const auto place = std::find(joints_.begin(), joints_.end(), joint);
      if (place != joints_.end()) found.push_back(static_cast<std::size_t>(place - joints_.begin()));
    }
    return found;
  }

 private:
  std::vector<std::uint32_t> joints_;
  std::size_t first_strain_;
  std::vector<std::vector<std::size_t>> spans_;  // of every muscle
  std::vector<std::size_t> muscle_of_fibre_;
};

// The shares of joints in what a region's features explain.
Shares explained_shares(const FeatureJoints& joints, const RegionModel& region) {
  Shares shares = Shares::Zero(static_cast<Eigen::Index>(joints.count()));
  for (std::size_t k = 0; k < region.features.size(); ++k) {
    const std::vector<std::size_t> own = joints.of(region.features[k]);
    for (const std::size_t j : own) {
      shares[static_cast<Eigen::Index>(j)] += region.explained[k] / static_cast<double>(own.size());
    }
  }
  scale_to_one(shares);
  return shares;
}

// The shares of joints in a region's skin.
Shares skin_shares(const FeatureJoints& joints, const Character& character, const RegionWeights& region) {
  Shares shares = Shares::Zero(static_cast<Eigen::Index>(joints.count()));
  for (std::size_t v = 0; v < region.vertices.size(); ++v) {
    for (const JointWeight& w : character.weights[region.vertices[v]]) {
      for (const std::size_t j : joints.places({w.joint})) {
        shares[static_cast<Eigen::Index>(j)] += region.weights[v] * w.weight;
      }
    }
  }
  scale_to_one(shares);
  return shares;
}

using Eigen::Index;

constexpr std::array kStrengths = {4.0, 1.0, 1.0 / 4, 1.0 / 16, 1.0 / 64};  // from the usual one on
constexpr double kAsGood = 1.01;                                            // root mean square, to the least
constexpr int kParts = 5;

// The frames in parts, one after the other, each as far from the rest as another shot.
std::vector<int> parts_of(const std::vector<std::size_t>& origins) {
  std::size_t count = 0;  // of frames that are no mirror images
  for (std::size_t n = 0; n < origins.size(); ++n) count += origins[n] == n;
  std::vector<int> parts;
  for (std::size_t n = 0, place = 0; n < origins.size(); ++n) {
    parts.push_back(origins[n] == n ? static_cast<int>(kParts * place++ / count) : parts[origins[n]]);
  }
  return parts;
}

std::vector<FeatureRange> shown_ranges(const RawFeatures& frames) {
  std::vector<FeatureRange> ranges(static_cast<std::size_t>(frames.cols()));
  for (Index k = 0; k < frames.cols(); ++k) {
    ranges[static_cast<std::size_t>(k)].low = std::min(0.0f, frames.col(k).minCoeff());
    ranges[static_cast<std::size_t>(k)].high = std::max(0.0f, frames.col(k).maxCoeff());
  }
  return ranges;
}

// N x regions: how far every frame stands off what the other parts show, as each region minds it.
Eigen::MatrixXd frames_off(const Groundwork& ground, const std::vector<int>& folds, const FadeTable& table,
                           const std::vector<int>& parts) {
  const Skeleton& skeleton = ground.base.basis.skeleton;
  const RawFeatures joints = ground.features.raw.leftCols(joint_feature_count(skeleton));
  Eigen::MatrixXd off(joints.rows(), static_cast<Index>(table.region_begin.size()) - 1);
  for (int part = 0; part < kParts; ++part) {
    const std::vector<Index> others = rows_where(parts, [&](int of) { return of != part; }),
                             own = rows_where(parts, [&](int of) { return of == part; });
    const RawFeatures shown = joints(others, Eigen::all);
    std::vector<int> others_folds;
    for (const Index n : others) others_folds.push_back(folds[static_cast<std::size_t>(n)]);
    ResidualTable residual;
    residual.regions.resize(static_cast<std::size_t>(off.cols()));
    residual.features = shown_ranges(shown);
    residual.fade = joint_manifold(skeleton, shown, others_folds);
    residual.fade.region_begin = table.region_begin;
    residual.fade.region_joints = table.region_joints;
    residual.fade.region_weights = table.region_weights;
    parallel_for(own.size(), [&](std::size_t k) {
      const std::span<const float> frame(joints.row(own[k]).data(), static_cast<std::size_t>(joints.cols()));
      const std::vector<float> fades = region_fades(residual, frame);
      for (std::size_t r = 0; r < fades.size(); ++r) off(own[k], static_cast<Index>(r)) = 1 / double{fades[r]} - 1;
    });
  }
  return off;
}

// The error that each strength leaves of a region's motion, square metres.
std::array<double, kStrengths.size()> left_of(const Groundwork& ground, const RegionModel& region,
                                              const std::vector<int>& parts, const Eigen::VectorXd& off) {
  const Regression& fit = region.fits.front();
  const RegressionData data = regression_data(ground.features, region, parts);
  const Eigen::VectorXd lengths = component_lengths(region.components, region.region);
  const Eigen::MatrixXd motion = region.components.coefficients * lengths.asDiagonal();
  const Eigen::MatrixXd predicted =
      motion + refit_regression(data, static_cast<int>(fit.centres.rows()), fit).errors * lengths.asDiagonal();
  std::array<double, kStrengths.size()> left{};
  for (std::size_t s = 0; s < left.size(); ++s) {
    const Eigen::ArrayXd fade = (1 + kStrengths[s] * off.array()).inverse();
    left[s] = (predicted.array().colwise() * fade - motion.array()).square().sum();
  }
  return left;
}

double strongest_of_the_best(const std::array<double, kStrengths.size()>& left) {
  const double most = kAsGood * kAsGood * *std::min_element(left.begin(), left.end());
  const auto strongest = std::find_if(left.begin(), left.end(), [&](double squares) { return squares <= most; });
  return strongest == left.end() ? kStrengths.front() : kStrengths[static_cast<std::size_t>(strongest - left.begin())];
}

}  // namespace

FadeTable fade_table(const Groundwork& ground, const std::vector<RegionModel>& regions, const std::vector<int>& folds,
                     const std::vector<std::size_t>& origins) {
  const Basis& basis = ground.base.basis;
  const FeatureJoints joints(basis, ground.muscles);
  FadeTable table = joint_manifold(basis.skeleton, ground.features.raw, folds);
  const std::vector<double> turns = joint_turns(ground.features.raw, joints.count());
  table.region_begin = {0};
  for (const RegionModel& region : regions) {
    const Shares shares = (1 - kSkinShare) * explained_shares(joints, region) +
                          kSkinShare * skin_shares(joints, ground.ordered, region.region);
    for (std::size_t j = 0; j < joints.count(); ++j) {
      const double share = shares[static_cast<Eigen::Index>(j)];
      if (share < kNegligible) continue;
      table.region_joints.push_back(static_cast<std::uint32_t>(j));
      table.region_weights.push_back(static_cast<float>(share / std::max(turns[j], kLeastTurn * kLeastTurn)));
    }
    table.region_begin.push_back(static_cast<std::uint32_t>(table.region_joints.size()));
  }
  const std::vector<double> strengths = fade_strengths(ground, regions, folds, origins, table);
  for (std::size_t r = 0; r < regions.size(); ++r) {
    for (std::uint32_t k = table.region_begin[r]; k < table.region_begin[r + 1]; ++k) {
      table.region_weights[k] *= static_cast<float>(strengths[r]);
    }
  }
  return table;
}

std::vector<double> fade_strengths(const Groundwork& ground, const std::vector<RegionModel>& regions,
                                   const std::vector<int>& folds, const std::vector<std::size_t>& origins,
                                   const FadeTable& table) {
  const std::vector<int> parts = parts_of(origins);
  const Eigen::MatrixXd off = frames_off(ground, folds, table, parts);
  std::vector<double> strengths(regions.size());
  parallel_for(regions.size(), [&](std::size_t r) {
    strengths[r] = strongest_of_the_best(left_of(ground, regions[r], parts, off.col(static_cast<Index>(r))));
  });
  return strengths;
}

}  // namespace bodyopt::trainer
