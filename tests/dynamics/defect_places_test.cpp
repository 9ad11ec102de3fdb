#include <gtest/gtest.h>

#include <set>

#include "tests/simulate/limb.h"
#include "trainer/dynamics/build_dynamics.h"

namespace bodyopt::trainer {
namespace {

TEST(DefectPlaces, NameEachDefectAndItsJoint) {
  const Character sound = make_limb();
  EXPECT_EQ(defect_places(sound), "");
  const Eigen::Index faces = sound.triangles.rows(), in_upper = 5;  // of the upper limb's skin

  Character limb = sound;
  limb.triangles.row(in_upper) = limb.triangles.row(faces - 1);
  const std::string open = defect_places(limb);
  EXPECT_TRUE(open.starts_with("; the skin is open at 'upper' (")) << open;

  limb = sound;
  std::swap(limb.triangles(in_upper, 0), limb.triangles(in_upper, 1));
  const std::string turned = defect_places(limb);
  EXPECT_TRUE(turned.starts_with("; the skin turns inside out at 'upper' (")) << turned;

  limb = sound;
  const Eigen::Index tip = limb.vertices.rows();
  limb.vertices.conservativeResize(tip + 1, 3);
  limb.vertices.row(tip) << 0.1, 0.3, 0;
  limb.weights.push_back({{0, 1.0}});
  limb.triangles.conservativeResize(faces + 1, 3);
  limb.triangles.row(faces) << limb.triangles(in_upper, 0), limb.triangles(in_upper, 1),
      static_cast<std::uint32_t>(tip);
  const std::string fused = defect_places(limb);
  EXPECT_NE(fused.find("; the skin is fused along an edge at 'upper' ("), std::string::npos) << fused;

  limb = sound;
  limb.vertices.row(5 * kTubeSides).tail(2) *= -1.3;
  const std::string crossed = defect_places(limb);
  EXPECT_TRUE(crossed.starts_with("; the skin passes through itself at 'upper' (")) << crossed;
}

// Three joints are named, the others counted.
TEST(DefectPlaces, ManyJointsAreCutShort) {
  Character limb = make_limb();
  for (std::size_t j = 2; j < 5; ++j) {
    limb.skeleton.joints.push_back(limb.skeleton.joints[1]);
    limb.skeleton.joints[j].name = "j" + std::to_string(j);
  }
  limb.triangles = limb.triangles.topRows(20).eval();
  const std::set<std::uint32_t> used(limb.triangles.data(), limb.triangles.data() + limb.triangles.size());
  std::uint32_t joint = 0;
  for (const std::uint32_t v : used) limb.weights[v] = {{joint++ % 5, 1.0}};
  const std::string text = defect_places(limb);
  EXPECT_NE(text.find("'j2' ("), std::string::npos) << text;
  EXPECT_EQ(text.find("'j3'"), std::string::npos) << text;
  EXPECT_TRUE(text.ends_with(" and 2 more")) << text;
}

}  // namespace
}  // namespace bodyopt::trainer
