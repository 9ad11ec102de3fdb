// Errors of a trained limb by area and by part, against sums over its vertices.
#include "trainer/train/judge/test_errors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/surface_distance.h"
#include "runtime/core/error.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/trained_basis.h"
#include "trainer/train/coverage/coverage.h"
#include "trainer/train/fit/train.h"

namespace bodyopt::trainer {
namespace test_errors_test {

const SampleSet& samples() {
  static const SampleSet set = limb_samples(160, 60);
  return set;
}

const Basis& basis() {
  static const Basis trained = trained_basis(samples(), {.centres = 60});
  return trained;
}

TEST(TestErrors, AreThoseOfTheVerticesByArea) {
  const std::vector<TakeErrors> takes = test_errors(basis(), samples());
  ASSERT_EQ(takes.size(), 1u);
  ASSERT_EQ(takes[0].frames.size(), samples().heldout.size());
  Deformer deformer(basis(), {.name = "cpu"});
  const VertexErrors errors = vertex_errors(samples(), heldout_by_basis(samples(), deformer));
  const Character& limb = samples().character;
  const Eigen::VectorXd areas = lumped_areas(limb.vertices, limb.triangles);
  EXPECT_NEAR(takes[0].errors.full, std::sqrt(errors.mean_square.dot(areas) / areas.sum()), 1e-9);
  double area = 0, energy = 0;
  for (const PartErrors& part : takes[0].parts) {
    area += part.area;
    energy += part.area * part.errors.full * part.errors.full;
  }
  EXPECT_NEAR(area, areas.sum(), 1e-9);
  EXPECT_NEAR(std::sqrt(energy / area), takes[0].errors.full, 1e-9);
  EXPECT_LT(takes[0].errors.full, 0.1 * takes[0].errors.ddm);
  EXPECT_TRUE(harmed_parts(takes[0], 0.02).empty());
  EXPECT_GT(takes[0].errors.expected, 0.4 * takes[0].errors.full);
  EXPECT_LT(takes[0].errors.expected, 2.5 * takes[0].errors.full);
}

// Shapes that are off by 5 mm at the wrist alone.
TEST(TestErrors, HarmIsFoundInThePartThatHasIt) {
  SampleSet set = samples();
  Deformer plain(without_residual(basis()), {.name = "cpu"});
  for (Sample& sample : set.heldout) {
    const Evaluation ddm = plain.evaluate({&sample.pose, 1});
    sample.shape = welded_from_output(set.character, ddm.positions.data());  // nothing to learn: every correction harms
  }
  set.heldout.resize(10);
  const std::vector<TakeErrors> takes = test_errors(basis(), set);
  EXPECT_LT(takes[0].errors.ddm, 1e-3);
  EXPECT_EQ(harmed_parts(takes[0], 0.02).size(), takes[0].parts.size());
}

TEST(TestErrors, FramesToLearnFromAreTestedWhereNoneIsHeldOut) {
  SampleSet set = samples();
  set.heldout.clear();
  EXPECT_EQ(test_errors(basis(), set)[0].frames.size(), set.train.size());
}

// Limits that couple two joints: what was learned of both together is not trusted of one alone.
TEST(TestErrors, PosesOffTheTrainedOnesFadeAndAreNoWorseThanUntrained) {
  SampleSet set = samples();
  const Skeleton& skeleton = set.character.skeleton;
  for (std::size_t k = 0; k < set.train.size(); ++k) {
    const double bend = 0.6 * std::sin(0.37 * static_cast<double>(k)) + 0.6;
    set.train[k].pose = limb_pose(skeleton, bend, 0, 0.5 * bend);
    set.train[k].shape = limb_truth(set.character, set.muscles, set.train[k].pose);
  }
  const Basis coupled = trained_basis(set, {.centres = 60});
  for (std::size_t k = 0; k < set.heldout.size(); ++k) {
    set.heldout[k].pose = k % 2 == 0 ? limb_pose(skeleton, 1.1, 0, 0.05) : limb_pose(skeleton, 0.1, 0, 0.5);
    set.heldout[k].shape = limb_truth(set.character, set.muscles, set.heldout[k].pose);
  }
  const TakeErrors apart = test_errors(coupled, set)[0];
  for (const FrameErrors& frame : apart.frames) {
    EXPECT_LT(frame.fade, 0.8);
    EXPECT_NE(frame.fading_joint, "");
  }
  EXPECT_LT(apart.errors.full, 1.02 * apart.errors.ddm);
  EXPECT_TRUE(harmed_parts(apart, 0.02).empty());
  set.heldout = set.train;
  const std::vector<TakeErrors> known = test_errors(coupled, set);
  for (const FrameErrors& frame : known[0].frames) EXPECT_EQ(frame.fade, 1);
}

TEST(TestErrors, ABasisOfAnotherCharacterIsRefused) {
  SampleSet other = samples();
  other.character.vertices *= 1.5;
  EXPECT_THROW(test_errors(basis(), other), Error);
}

}  // namespace test_errors_test
}  // namespace bodyopt::trainer
