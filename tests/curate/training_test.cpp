// What a training learns of curated shapes.
#include <gtest/gtest.h>

#include <array>

#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "tests/curate/curated_limb.h"
#include "tests/curate/sweep_history.h"
#include "trainer/curate/edit_stack.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/fit/train.h"

namespace bodyopt::trainer {
namespace {

Basis trained(const CuratedLimb& limb) {
  SampleSet set = read_samples(read_dataset(limb.path()));
  set.muscles = limb_muscles();
  return train(set, {.smoothing_radius = 0.02}).basis;
}

Positions evaluated(Deformer& deformer, const CuratedLimb& limb, const Pose& pose) {
  return welded_from_output(limb.character(), deformer.evaluate({&pose, 1}).positions.data());
}

// RMS, mm, against the true shapes at angles that no frame of the dataset has.
double heldout_rms_mm(const CuratedLimb& limb, const std::vector<double>& twists = {0}) {
  Deformer deformer(trained(limb), {.name = "cpu"});
  double sum = 0;
  int count = 0;
  for (double degrees = 3; degrees < 120; degrees += 6, ++count) {
    const double twist = twists[static_cast<std::size_t>(count) % twists.size()] * std::sin(kDegree * degrees);
    const Pose pose =
        limb_pose(limb.character().skeleton, kDegree * degrees, kDegree * twist, twists.size() == 1 ? 0.01 : 0);
    sum += std::pow(rms_mm(evaluated(deformer, limb, pose), limb_truth(limb.character(), limb_muscles(), pose)), 2);
  }
  return std::sqrt(sum / count);
}

TEST(CuratedTraining, LearnsOfConsistentShapesWhatItLearnsOfCleanOnes) {
  const Character character = limb_character();
  const auto history = [&](int take, int frame, const Positions& truth) {
    return with_history(character, take, frame, truth);
  };
  const CuratedLimb clean, raw(history), consistent(history);
  add_modifier(consistent.path(), {.type = "consistency"});
  const double of_clean = heldout_rms_mm(clean), of_raw = heldout_rms_mm(raw),
               of_consistent = heldout_rms_mm(consistent);
  std::printf(
      "held out: %.4f mm RMS learned of clean shapes, %.4f of those that disagree, %.4f of these made consistent\n",
      of_clean, of_raw, of_consistent);
  EXPECT_LT(of_consistent, 1.1 * of_clean);
  EXPECT_GT(of_raw, 10 * of_clean);
}

// RMS, mm, against the truth at angles between those that were trained on.
TEST(CuratedTraining, LearnsASculptWhereItIsAndNothingElsewhere) {
  const CuratedLimb plain, limb;
  const auto at = [&](int frame) { return static_cast<std::size_t>(frame - 1); };
  Positions bulge = Positions::Zero(limb.character().vertices.rows(), 3);
  for (Eigen::Index v = 0; v < bulge.rows(); ++v) {
    const double along = (limb.character().vertices(v, 2) - 0.3) / 0.05, side = limb.character().vertices(v, 1);
    if (side > 0) bulge(v, 1) = 0.01 * std::pow(side / kLimbRadius, 2) * std::exp(-along * along);
  }
  const Positions sculpt = limb.character().vertices + limb.stack().offsets(at(16), 0) + bulge;
  sculpt_frame(limb, "elbow", "one", 16, output_from_welded(limb.character(), sculpt), true, 60);
  Deformer with(trained(limb), {.name = "cpu"}), without(trained(plain), {.name = "cpu"});
  Eigen::Index top;
  bulge.col(1).maxCoeff(&top);
  std::array<double, 4> peaks{};
  const std::array<int, 4> frames{16, 11, 5, 2};  // 90, 60 (half of the spread away), 24 and 6 degrees
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const Pose pose = limb.pose(0, frames[k]);
    peaks[k] = 1e3 * (evaluated(with, limb, pose) - evaluated(without, limb, pose)).row(top).norm();
  }
  const double whole = 1e3 * bulge(top, 1);
  std::printf("a sculpt of %.2f mm: %.2f at its pose, %.2f half-way, %.3f and %.3f elsewhere\n", whole, peaks[0],
              peaks[1], peaks[2], peaks[3]);
  EXPECT_NEAR(peaks[0], whole, 0.05 * whole);
  EXPECT_NEAR(peaks[1], 0.5 * whole, 0.05 * whole);
  EXPECT_LT(std::max(peaks[2], peaks[3]), 0.05);
}

// Without its other half a body learns nearly all of it in the mirror. Angles between those of the takes
// would tell of cross-validation instead: it has an image and its origin in one fold, but the twins of two takes apart.
TEST(CuratedTraining, LearnsOfMirrorImagesWhatItLearnsOfTheOtherHalf) {
  const auto truth = [](int, int, const Positions& shape) { return shape; };
  const CuratedLimb all(truth, {40, -40}), half(truth, {40, -40}), alone(truth, {40, -40});
  for (const CuratedLimb* limb : {&half, &alone}) {
    add_modifier(limb->path(), {.type = "drop", .frames = {{{"take", "two"}}}});
  }
  add_modifier(half.path(), {.type = "symmetry"});
  const std::vector<double> twists{40, -40};
  const double of_all = heldout_rms_mm(all, twists), of_half = heldout_rms_mm(half, twists),
               of_one_side = heldout_rms_mm(alone, twists);
  std::printf(
      "held out: %.4f mm RMS learned of all poses, %.4f of half of them and their mirror images, %.4f of half\n",
      of_all, of_half, of_one_side);
  EXPECT_LT(of_half, 0.01 * of_one_side);
  EXPECT_LT(of_all, 0.01 * of_one_side);
}

}  // namespace
}  // namespace bodyopt::trainer
