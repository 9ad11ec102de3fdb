// Features beyond their trained range, as people say it.
#include <gtest/gtest.h>

#include "runtime/deformer/deformer.h"
#include "runtime/host/rig.h"
#include "tests/support/small_basis.h"

namespace bodyopt::testing {
namespace {

// Nine features of the joint that turns, one of each of two fibres, one of the control.
TEST(OutsideText, HasTheUnitOfItsFeature) {
  const Basis basis = small_basis();
  const auto text = [&](std::uint32_t feature, float by) {
    return feature_name(basis, feature) + ", by " + outside_text(basis, feature, by);
  };
  EXPECT_EQ(text(0, 12.34f), "joint upper, by 12.3 degrees");
  EXPECT_EQ(text(8, 12.34f), "joint upper, by 12.3 degrees");
  EXPECT_EQ(text(9, 0.045f), "strain flexor/0, by 4.5 % of its length");
  EXPECT_EQ(text(10, 0.045f), "strain flexor/1, by 4.5 % of its length");
  EXPECT_EQ(text(11, 0.2f), "control breath, by 20.0 %");
}

TEST(OutsideText, OfAJointThatSlidesIsInMillimetres) {
  Basis basis = small_basis();
  basis.skeleton.features = joint_features_of(basis.skeleton);
  basis.skeleton.features.front().per_metre = 4;
  EXPECT_EQ(feature_name(basis, 1), "place of joint upper");
  EXPECT_EQ(outside_text(basis, 1, 0.0123f), "12.3 mm");
}

}  // namespace
}  // namespace bodyopt::testing
