#include "trainer/train/fit/fade.h"

#include <algorithm>
#include <numeric>

#include "runtime/host/rig.h"
#include "trainer/train/features/joint_manifold.h"
#include "trainer/train/features/strain.h"
#include "trainer/train/fit/fade_strength.h"

namespace bodyopt {
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

  // Of joints of the skeleton those that have features.
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

// What its features explain, by joint.
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

// Its skin, by joint.
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

}  // namespace

FadeTable fade_table(const Groundwork& ground, const std::vector<RegionModel>& regions, const std::vector<int>& folds) {
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
  const std::vector<double> strengths = fade_strengths(ground, regions, folds, table);
  for (std::size_t r = 0; r < regions.size(); ++r) {
    for (std::uint32_t k = table.region_begin[r]; k < table.region_begin[r + 1]; ++k) {
      table.region_weights[k] *= static_cast<float>(strengths[r]);
    }
  }
  return table;
}

}  // namespace bodyopt
