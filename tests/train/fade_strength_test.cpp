// How strongly what was learned fades: as the frames themselves say, where they say anything.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/host/rig.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/trained_basis.h"
#include "trainer/train/fit/fade.h"
#include "trainer/train/judge/test_errors.h"

namespace bodyopt::trainer {
namespace {

constexpr double kLeastTurn = 0.05;  // as fade_table() has it

// What a region's weights add up to, which are shares of one over what each joint turned.
double strength_in(const Basis& basis, const SampleSet& set) {
  std::vector<double> turns(feature_joints(basis.skeleton).size());
  for (const Sample& sample : set.train) {
    const std::vector<float> features = pose_rig(basis.skeleton, sample.pose).joint_features;
    for (std::size_t k = 0; k < features.size(); ++k) {
      turns[k / 9] += std::pow(double{features[k]}, 2) / static_cast<double>(set.train.size());
    }
  }
  const FadeTable& fade = basis.residual.fade;
  double sum = 0;
  for (std::uint32_t k = fade.region_begin[0]; k < fade.region_begin[1]; ++k) {
    sum += double{fade.region_weights[k]} * std::max(turns[fade.region_joints[k]], kLeastTurn * kLeastTurn);
  }
  return sum;
}

// A bend of so many radians in every frame.
template <typename Bend>
void bend(std::vector<Sample>& samples, const SampleSet& set, const Bend& angle) {
  for (std::size_t k = 0; k < samples.size(); ++k) {
    samples[k].pose = limb_pose(set.character.skeleton, angle(static_cast<double>(k)), 0, 0);
    samples[k].shape = limb_truth(set.character, set.muscles, samples[k].pose);
  }
}

// Every fifth shows what the others do.
TEST(FadeStrength, IsTheUsualOneWhereNothingTells) {
  SampleSet set = limb_samples(100, 0);
  bend(set.train, set, [](double k) { return 0.7 + 0.5 * std::sin(std::numbers::pi / 10 * k); });
  EXPECT_GT(strength_in(trained_basis(set, {.centres = 60}), set), 3.5);
}

// Each fifth of a slow bend goes on from the last, and what the others show still holds there.
TEST(FadeStrength, IsLessWhereWhatWasLearnedHoldsFurtherOff) {
  SampleSet set = limb_samples(100, 20);
  bend(set.train, set, [](double k) { return 0.2 + 0.01 * k; });
  bend(set.heldout, set, [](double k) { return 1.2 + 0.015 * k; });
  const Basis basis = trained_basis(set, {.centres = 60});
  EXPECT_LT(strength_in(basis, set), 1.1);
  const TakeErrors further = test_errors(basis, set)[0];
  RecordProperty("full over Direct Delta Mush", std::to_string(further.errors.full / further.errors.ddm));
  EXPECT_LT(further.errors.full, 0.4 * further.errors.ddm);
}

}  // namespace
}  // namespace bodyopt::trainer
