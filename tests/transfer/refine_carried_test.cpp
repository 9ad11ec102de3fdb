// Carried frames that learn from a body's own.
#include <gtest/gtest.h>

#include "runtime/host/device_choice.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/error_kind.h"
#include "trainer/train/skinning/ddm.h"
#include "trainer/transfer/skin_transfer.h"

namespace bodyopt::trainer {
namespace {

// Two takes of the limb. Of the carried one shapes are half-way between Direct Delta Mush and the truth.
SampleSet carried_and_own(int carried_frames, int own_frames) {
  SampleSet set = limb_samples(carried_frames + own_frames, 0);
  set.takes = {"carried", "own"};
  Deformer bare(build_ddm_basis(set.character, {}), {.name = "cpu"});
  for (std::size_t k = 0; k < set.train.size(); ++k) {
    Sample& sample = set.train[k];
    sample.take = k % (set.train.size() / static_cast<std::size_t>(own_frames)) == 0 ? 1 : 0;
    if (sample.take == 1) continue;
    const std::vector<float> ddm = bare.evaluate({&sample.pose, 1}).positions;
    sample.shape = SampleShape((0.5 * (sample.shape.read() + welded_from_output(set.character, ddm.data()))).eval());
  }
  return set;
}

double apart(const Positions& a, const Positions& b) {
  return std::sqrt((a - b).squaredNorm() / static_cast<double>(a.rows()));
}

}  // namespace

TEST(RefineCarried, CarriedFramesComeNearTheTruth) {
  const SampleSet set = carried_and_own(60, 20);
  RefinedShapes refined(set, {"carried"}, {});
  double before = 0, after = 0;
  for (const Sample& sample : set.train) {
    if (sample.take == 1) continue;
    const Positions truth = limb_truth(set.character, set.muscles, sample.pose);
    before += apart(sample.shape.read(), truth);
    after += apart(welded_from_output(set.character, refined(sample.pose).data()), truth);
  }
  EXPECT_GT(refined.difference_mm(), 0.1);
  EXPECT_LT(after, 0.5 * before);
}

TEST(RefineCarried, NeedsFramesOfBothKinds) {
  const SampleSet set = carried_and_own(20, 5);
  EXPECT_EQ(testing::kind_of([&] { RefinedShapes(set, {"walk"}, {}); }), ErrorKind::usage);
  EXPECT_EQ(testing::kind_of([&] { RefinedShapes(set, {"carried", "own"}, {}); }), ErrorKind::mismatch);
}

}  // namespace bodyopt::trainer
