#include "bench/over_large.h"

#include <gtest/gtest.h>

#include "geometry/extent.h"
#include "tests/support/capsule_limb.h"
#include "trainer/train/skinning/mesh_table.h"

namespace bodyopt::bench {
namespace {

// What is left is rounding: 0.05 mm of 1.8 m.
TEST(OverLargeBasis, HoldsItsTrainingFrames) {
  const SampleSet set = limb_samples(100, 0);
  const double distance = largest_distance(over_large_basis(set), set);
  RecordProperty("mm", std::to_string(1e3 * distance));
  EXPECT_LT(distance, 5e-5 * longest_extent(set.character.vertices) / 1.8);
}

}  // namespace
}  // namespace bodyopt::bench
