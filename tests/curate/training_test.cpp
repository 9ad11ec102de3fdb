// What a training learns of curated shapes.
#include <gtest/gtest.h>

#include <array>

#include "runtime/deformer/deformer.h"
#include "tests/curate/curated_limb.h"
#include "tests/curate/sweep_history.h"
#include "trainer/curate/edit_stack.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/fit/train.h"

namespace bodyopt {
namespace {

Basis trained(const CuratedLimb& limb) {
  SampleSet set = read_samples(read_dataset(limb.path()));
  set.muscles = limb_muscles();
  return train(set, {}).basis;
}

Positions evaluated(Deformer& deformer, const CuratedLimb& limb, const Pose& pose) {
  return welded_from_output(limb.character(), deformer.evaluate({&pose, 1}).positions.data());
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
  add_sculpt(limb.path(), "elbow", "one", 16, output_from_welded(limb.character(), sculpt), true, 60);
  Deformer with(trained(limb), {.name = "cpu"}), without(trained(plain), {.name = "cpu"});
  Eigen::Index top;
  bulge.col(1).maxCoeff(&top);
  std::array<double, 3> peaks{};
  const std::array<int, 3> frames{16, 11, 2};  // 90, 60 (half of the spread away), 6 degrees
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const Pose pose = limb.pose(0, frames[k]);
    peaks[k] = 1e3 * (evaluated(with, limb, pose) - evaluated(without, limb, pose)).row(top).norm();
  }
  const double whole = 1e3 * bulge(top, 1);
  std::printf("a sculpt of %.2f mm: %.2f at its pose, %.2f half-way, %.3f elsewhere\n", whole, peaks[0], peaks[1],
              peaks[2]);
  EXPECT_NEAR(peaks[0], whole, 0.1 * whole);
  EXPECT_NEAR(peaks[1], 0.5 * whole, 0.15 * whole);
  EXPECT_LT(peaks[2], 0.1 * whole);
}

}  // namespace
}  // namespace bodyopt
