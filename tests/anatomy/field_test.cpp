// The inside of a body at any point: the same on both sides, and no less where the skin is bad.
#include "trainer/anatomy/field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "runtime/core/error.h"
#include "tests/anatomy/egg_human.h"
#include "tests/support/error_kind.h"
#include "tests/support/stand_in_human.h"

namespace {

using namespace bodyopt;
using namespace bodyopt::trainer;
using Eigen::Vector3d;

AnatomyOptions coarse() {
  AnatomyOptions options;
  options.cell = 0.012;
  return options;
}

const AnatomyField& egg_field() {
  static const AnatomyField field(egg_human(), {}, coarse());
  return field;
}

std::vector<Vector3d> points_within(double wide, double high, double deep) {
  std::vector<Vector3d> points;
  for (int k = 0; k < 4000; ++k) {  // additive recurrence: evenly spread
    const auto part = [&](double turn) { return std::fmod(0.5 + turn * k, 1.0); };
    points.emplace_back(wide * part(0.8191725134), high * part(0.6710436067), deep * (part(0.5497004779) - 0.5));
  }
  return points;
}

TEST(AnatomyField, LeftAndRightAreTheSame) {
  const AnatomyField& field = egg_field();
  ASSERT_TRUE(field.is_own_mirror());
  const Character egg = egg_human();
  const std::vector<int> others = mirrored_joints(egg);
  int bones = 0;
  for (const Vector3d& point : points_within(0.3, 1.8, 0.45)) {
    const TissueAt left = field.tissue_at(point), right = field.tissue_at({-point.x(), point.y(), point.z()});
    ASSERT_EQ(left.kind, right.kind) << point.transpose();
    if (left.joint < 0) continue;
    ASSERT_EQ(others[static_cast<std::size_t>(left.joint)], right.joint) << point.transpose();
    ++bones;
  }
  EXPECT_GT(bones, 50);
}

TEST(AnatomyField, TellsWhatIsOutside) {
  const AnatomyField& field = egg_field();
  EXPECT_EQ(field.tissue_at({0, 2, 0}).kind, TissueKind::outside);
  EXPECT_EQ(field.tissue_at({1e300, 1, 0}).kind, TissueKind::outside);
  EXPECT_EQ(field.tissue_at({NAN, 1, 0}).kind, TissueKind::outside);
  EXPECT_EQ(field.tissue_at({0.275, 0.875, 0}).kind, TissueKind::fat) << "just under the skin";
  EXPECT_TRUE(field.fibre_at({0, 2, 0}).isZero());
}

TEST(AnatomyField, SaysAtItsSamplesWhatTheyAre) {
  const AnatomyField& field = egg_field();
  const AnatomyField::Half& half = field.halves().front();
  int same = 0;
  for (int s = 0; s < half.grid.size(); ++s)
    same += field.tissue_at(half.grid.points.row(s).transpose()).kind == half.tissue.kind(s) ? 1 : 0;
  EXPECT_NEAR(same, half.grid.size(), 5) << "a few lie on a border, but for rounding";
}

// Fat and skin are thinner than a cell in places: their border is read from the depth, not from cells.
TEST(AnatomyField, FatIsAsThickBetweenSamplesAsThePatternSays) {
  const AnatomyField& field = egg_field();
  const AnatomyField::Half& half = field.halves().front();
  for (int s = 0; s < half.grid.size(); s += 13) {
    const double thickness = half.grid.depth[s] - half.tissue.fat[s];
    if (half.grid.depth[s] > 0.012 || half.tissue.bone[s] < 0.012) continue;
    const Vector3d skin = half.grid.skin[static_cast<std::size_t>(s)].position;
    const Vector3d inwards = (half.grid.points.row(s).transpose() - skin).normalized();
    ASSERT_EQ(field.tissue_at(skin + 0.8 * thickness * inwards).kind, TissueKind::fat) << skin.transpose();
    ASSERT_NE(field.tissue_at(skin + 1.2 * thickness * inwards).kind, TissueKind::fat) << skin.transpose();
  }
}

TEST(AnatomyField, IsTheSameTwiceAndAnotherOfAnotherBody) {
  EXPECT_EQ(AnatomyField(egg_human(), {}, coarse()).hash(), egg_field().hash());
  AnatomyOptions fatter = coarse();
  fatter.body_fat = 0.25;
  EXPECT_NE(AnatomyField(egg_human(), {}, fatter).hash(), egg_field().hash());
}

// Of a body that is not its own mirror image both halves are looked at, each with its own joints.
TEST(AnatomyField, TwoHalvesMeetAtThePlane) {
  const Character human = stand_in_human();
  const AnatomyField field(human, {}, coarse());
  ASSERT_EQ(field.halves().size(), 2u);
  for (const char* name : {"LeftUpLeg", "RightUpLeg"}) {
    const auto joint = static_cast<std::size_t>(human.skeleton.find(name));
    const TissueAt tissue = field.tissue_at(Vector3d(bind_place(human.skeleton, joint).data()));
    EXPECT_EQ(tissue.kind, TissueKind::bone) << name;
    EXPECT_EQ(tissue.joint, static_cast<int>(joint)) << name << ": the head of its femur";
  }
}

TEST(AnatomyField, RefusesFatThatNoBodyHas) {
  for (const double fat : {0.0, 0.019, 0.61, 15.0, static_cast<double>(NAN)}) {
    AnatomyOptions options = coarse();
    options.body_fat = fat;
    EXPECT_EQ(bodyopt::testing::kind_of([&] { AnatomyField(egg_human(), {}, options); }), ErrorKind::usage) << fat;
  }
}

TEST(AnatomyField, OfABodyThatLostItsArm) {
  Character human = stand_in_human();
  std::vector<bool> lost(human.weights.size());
  for (std::size_t v = 0; v < lost.size(); ++v) {
    const std::string& joint = human.skeleton.joints[human.weights[v].front().joint].name;
    lost[v] = joint == "LeftForeArm" || joint == "LeftHand" || joint == "LThumb" || joint == "LeftFingerBase";
  }
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < human.triangles.rows(); ++t) {
    if (!lost[human.triangles(t, 0)] && !lost[human.triangles(t, 1)] && !lost[human.triangles(t, 2)]) kept.push_back(t);
  }
  human.triangles = Triangles(human.triangles(kept, Eigen::all));
  const AnatomyField field(human, {}, coarse());
  const auto place = [&](const char* name) {
    return Vector3d(bind_place(human.skeleton, static_cast<std::size_t>(human.skeleton.find(name))).data());
  };
  EXPECT_EQ(field.tissue_at(place("LeftHand")).kind, TissueKind::outside);
  EXPECT_NE(field.tissue_at(place("RightHand")).kind, TissueKind::outside);
  EXPECT_EQ(field.tissue_at(place("LeftUpLeg")).kind, TissueKind::bone);
  EXPECT_FALSE(field.halves().front().tissue.notes.empty()) << "the skin is open";
}

// Of another character, or made by hand.
TEST(AnatomyField, MusclesThatDoNotFitTheSkeletonAreRefused) {
  const MusclePoint hip{0, {0.1, 0.9, 0}}, nowhere{999, {0.1, 0.5, 0}}, knee{1, {0.1, 0.5, 0}};
  const auto refused = [](const Muscle& muscle) {
    return bodyopt::testing::kind_of([&] { AnatomyField(egg_human(), {muscle}, coarse()); });
  };
  Muscle muscle;
  muscle.name = "stray";
  muscle.radius = 0.01;
  for (const std::vector<MusclePoint>& path : {std::vector{hip}, std::vector{hip, nowhere}}) {
    muscle.path = path;
    EXPECT_EQ(refused(muscle), ErrorKind::mismatch);
  }
  muscle.path = {hip, knee};
  muscle.radius = 0;
  EXPECT_EQ(refused(muscle), ErrorKind::mismatch);
}

}  // namespace
