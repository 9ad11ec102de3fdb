// Halves of bodies: what is its own mirror image is looked at once, what lost an arm twice.
#include "trainer/anatomy/half_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/anatomy/egg_human.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/stand_in_human.h"

namespace {

using namespace bodyopt;
using namespace bodyopt::trainer;

// The same, moved along x.
Character moved(Character character, double way) {
  character.vertices.col(0).array() += way;
  for (Joint& joint : character.skeleton.joints) {
    if (joint.parent < 0) joint.bind.translation[0] += way;
    for (int k = 0; k < 3; ++k) joint.inverse_bind.m[k][3] -= joint.inverse_bind.m[k][0] * way;
  }
  return character;
}

TEST(HalfBody, SymmetricHumanIsOneHalf) {
  const std::vector<HalfBody> halves = halves_of(moved(egg_human(), 0.75));
  ASSERT_EQ(halves.size(), 1u);
  const HalfBody& half = halves.front();
  EXPECT_TRUE(half.has_plane);
  EXPECT_TRUE(half.is_own_mirror);
  const int left = half.find(BodyPart::thigh), right = half.find(BodyPart::thigh, BodySide::right);
  ASSERT_GE(left, 0);
  ASSERT_GE(right, 0);
  const auto place = [&](int joint) { return half.places[static_cast<std::size_t>(joint)]; };
  EXPECT_GT(place(left).x(), 0.02);
  EXPECT_NEAR(place(left).x(), -place(right).x(), 1e-12);
  EXPECT_NEAR(place(half.find(BodyPart::head)).x(), 0, 1e-12);
}

// A rig beside its skin, which is hardly its own mirror image: the plane is the skin's.
TEST(HalfBody, PlaneIsWhereTheSkinMirrorsBest) {
  const Character human = egg_human();
  Character beside = moved(human, 0.03);
  beside.vertices = human.vertices;
  for (Eigen::Index v = 0; v < beside.vertices.rows(); v += 7) beside.vertices(v, 1) += 2e-3;
  const std::vector<HalfBody> halves = halves_of(beside);
  ASSERT_EQ(halves.size(), 2u);
  const double middle = 0.5 * (human.vertices.col(0).minCoeff() + human.vertices.col(0).maxCoeff());
  EXPECT_NEAR((halves.front().from_rest * Eigen::Vector3d(middle, 0, 0)).x(), 0, 1e-9);
}

TEST(HalfBody, SidesAreEachOthersCounterparts) {
  const Character human = stand_in_human();
  const std::vector<int> others = mirrored_joints(human);
  const int left = human.skeleton.find("LeftForeArm"), right = human.skeleton.find("RightForeArm");
  ASSERT_GE(left, 0);
  EXPECT_EQ(others[static_cast<std::size_t>(left)], right);
  EXPECT_EQ(others[static_cast<std::size_t>(right)], left);
  const int head = human.skeleton.find("Head");
  EXPECT_EQ(others[static_cast<std::size_t>(head)], head);
}

TEST(HalfBody, SidesAreFoundByPlaceWhereNamesTellNone) {
  Character human = egg_human();
  const std::vector<int> named = mirrored_joints(human);
  for (std::size_t j = 0; j < human.skeleton.size(); ++j) human.skeleton.joints[j].name = "bone" + std::to_string(j);
  EXPECT_EQ(mirrored_joints(human), named);
}

TEST(HalfBody, BodyThatIsNotItsMirrorImageHasTwoHalves) {
  Character human = egg_human();
  const auto hand = static_cast<std::uint32_t>(human.skeleton.find("LeftHand"));
  for (std::size_t v = 0; v < human.weights.size(); ++v) {
    if (human.weights[v].front().joint == hand) human.vertices(static_cast<Eigen::Index>(v), 0) *= 0.8;
  }
  const std::vector<HalfBody> halves = halves_of(human);
  ASSERT_EQ(halves.size(), 2u);
  for (const HalfBody& half : halves) EXPECT_FALSE(half.is_own_mirror);
  // The plane stays where the joints have it, and each half has its own arm at the left.
  const Eigen::Vector3d place(0.3, 1, 0);
  EXPECT_NEAR((halves[0].from_rest * place).x(), -(halves[1].from_rest * place).x(), 1e-12);
  EXPECT_EQ(halves[0].find(BodyPart::hand), human.skeleton.find("LeftHand"));
  EXPECT_EQ(halves[1].find(BodyPart::hand), human.skeleton.find("RightHand"));
  for (const HalfBody& half : halves)
    EXPECT_GT(half.places[static_cast<std::size_t>(half.find(BodyPart::hand))].x(), 0.1);
}

// Which triangles have a corner that mostly follows one of these joints.
std::vector<bool> triangles_of(const Character& human, const std::vector<std::string>& joints) {
  std::vector<bool> own(static_cast<std::size_t>(human.triangles.rows()), false);
  for (Eigen::Index t = 0; t < human.triangles.rows(); ++t) {
    for (const std::uint32_t v : human.triangles.row(t)) {
      const std::string& joint = human.skeleton.joints[human.weights[v].front().joint].name;
      if (std::ranges::find(joints, joint) != joints.end()) own[static_cast<std::size_t>(t)] = true;
    }
  }
  return own;
}

Character without_triangles(Character human, const std::vector<bool>& lost) {
  std::vector<Eigen::Index> kept;
  for (std::size_t t = 0; t < lost.size(); ++t) {
    if (!lost[t]) kept.push_back(static_cast<Eigen::Index>(t));
  }
  human.triangles = Triangles(human.triangles(kept, Eigen::all));
  return human;
}

// Its vertices may be there still, loose.
TEST(HalfBody, LimbWithoutTrianglesIsNotMirroredAway) {
  const Character human = egg_human();
  for (const std::vector<std::string>& limb :
       {std::vector<std::string>{"LeftForeArm", "LeftHand"}, {"RightLeg", "RightFoot"}}) {
    const std::vector<HalfBody> halves = halves_of(without_triangles(human, triangles_of(human, limb)));
    ASSERT_EQ(halves.size(), 2u) << limb.front();
    EXPECT_NEAR((halves[0].from_rest * Eigen::Vector3d(0.1, 1, 0)).x(), 0.1, 1e-9) << "the plane stays";
  }
}

TEST(HalfBody, HoleOfOneTriangleIsSeen) {
  const Character human = egg_human();
  std::vector<bool> hole(static_cast<std::size_t>(human.triangles.rows()), false);
  hole[static_cast<std::size_t>(human.triangles.rows() / 2)] = true;
  EXPECT_EQ(halves_of(without_triangles(human, hole)).size(), 2u);
}

TEST(HalfBody, LooseVerticesAreNoSkin) {
  Character human = egg_human();
  const Eigen::Index count = human.vertices.rows();
  human.vertices.conservativeResize(count + 1, 3);
  human.vertices.row(count) << 0.4, 1, 0;
  human.weights.push_back(human.weights.front());
  EXPECT_EQ(halves_of(human).size(), 1u);
}

TEST(HalfBody, LimbAloneHasNoPlane) {
  const std::vector<HalfBody> halves = halves_of(limb_character());
  ASSERT_EQ(halves.size(), 1u);
  EXPECT_FALSE(halves.front().has_plane);
  EXPECT_FALSE(halves.front().is_own_mirror);
}

TEST(HalfBody, PathsAreSeenFromTheirSide) {
  const Character human = stand_in_human();  // as it was modelled: not quite its own mirror image
  const std::vector<HalfBody> halves = halves_of(human);
  ASSERT_EQ(halves.size(), 2u);
  const Muscle muscle{.name = "m", .path = {{0, {-0.2, 1, 0}}, {0, {-0.1, 0.5, 0.1}}}};
  EXPECT_GT(halves[1].path_of(muscle).path[0].position[0], 0.15);
  EXPECT_LT(halves[0].path_of(muscle).path[0].position[0], -0.15);
  EXPECT_DOUBLE_EQ(halves[1].path_of(muscle).path[1].position[2], halves[0].path_of(muscle).path[1].position[2]);
}

}  // namespace
