#include <gtest/gtest.h>

#include <algorithm>

#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "tests/support/limb_dynamics.h"
#include "trainer/dynamics/jiggle.h"

namespace bodyopt::trainer {
namespace {

NodeMotion at_rest(const Dynamics& dynamics) {
  const std::vector<float> zeros(dynamics.tets.nodes.size());
  return {zeros, zeros, dynamics.tets.nodes, zeros};
}

// Half a metre of an arm: linear tissue went so far, the skin is held short of its limit, and both are told.
TEST(MeasureJiggle, CountsSkinThatIsHeldByItsLimit) {
  const Dynamics& dynamics = limb_model().dynamics;
  NodeMotion motion = at_rest(dynamics);
  for (float& u : motion.displacement) u = 0.3f;
  const JiggleMeasure measure = measure_jiggle(dynamics, motion);
  const auto& limits = dynamics.tets.skin_limit;
  EXPECT_EQ(measure.limited, limits.size());
  EXPECT_LT(measure.max_mm, 1e3 * static_cast<double>(*std::ranges::max_element(limits)));
  EXPECT_NEAR(limits[measure.most_limited], *std::ranges::min_element(limits), 1e-5f);
}

TEST(MeasureJiggle, OfTheSkinInMillimetres) {
  const Dynamics& dynamics = limb_model().dynamics;
  NodeMotion motion = at_rest(dynamics);
  EXPECT_EQ(measure_jiggle(dynamics, motion).max_mm, 0);
  for (std::size_t k = 0; k < motion.displacement.size(); k += 3) {
    motion.displacement[k] = 0.003f;
    motion.displacement[k + 2] = -0.004f;
  }
  const JiggleMeasure shifted = measure_jiggle(dynamics, motion);
  EXPECT_NEAR(shifted.rms_mm, 5, 1e-5);
  EXPECT_NEAR(shifted.max_mm, 5, 1e-5);
  EXPECT_EQ(shifted.limited, 0u);
  // What Deformer does to the skin.
  Deformer still(limb_model().basis, {.name = "cpu"}), moving(limb_model().basis, dynamics, {}, {.name = "cpu"});
  const Pose from = limb_pose({}), to = limb_pose({{0.05, 0, 0}, 0, 0.3});
  moving.jiggle(std::vector<Pose>{from, from, to}, std::vector<int>{1, 2, 3});
  const Evaluation moved = moving.jiggle({&to, 1}, std::vector<int>{4}), there = still.evaluate({&to, 1});
  double largest = 0;
  for (std::size_t k = 0; k < moved.positions.size(); k += 3) {
    double squared = 0;
    for (std::size_t i = k; i < k + 3; ++i) {
      squared += std::pow(static_cast<double>(moved.positions[i]) - static_cast<double>(there.positions[i]), 2);
    }
    largest = std::max(largest, std::sqrt(squared));
  }
  const JiggleMeasure measure = measure_jiggle(dynamics, moving.state().motion);
  EXPECT_GT(measure.max_mm, 1);
  EXPECT_NEAR(measure.max_mm, 1e3 * largest, 1e-3);
  EXPECT_LT(measure.rms_mm, measure.max_mm);
}

TEST(MeasureJiggle, CountsTetsThatAreInsideOut) {
  const Dynamics& dynamics = limb_model().dynamics;
  NodeMotion motion = at_rest(dynamics);
  EXPECT_EQ(measure_jiggle(dynamics, motion).inverted_tets, 0u);
  for (std::size_t k = 0; k < motion.nodes.size(); k += 3) motion.nodes[k] *= -1;
  EXPECT_EQ(measure_jiggle(dynamics, motion).inverted_tets, dynamics.tets.tet_count());
}

}  // namespace
}  // namespace bodyopt::trainer
