// Bone, fat and cavity of humans: as much of them as anatomists find, on any grid, of any skin.
#include "trainer/anatomy/inner_tissue.h"

#include <gtest/gtest.h>

#include <array>
#include <map>

#include "tests/anatomy/egg_human.h"
#include "tests/support/shared_data.h"
#include "tests/support/stand_in_human.h"

namespace {

using namespace bodyopt;
using namespace bodyopt::trainer;

struct Inside {
  HalfBody body;
  BodyGrid grid;
  InnerTissue tissue;

  Inside(const Character& character, double cell, double body_fat) {
    body = halves_of(character).front();
    grid = sample_body(body, cell);
    tissue = find_inner_tissue(body, grid, {body_fat, BodyKind::biped});
  }

  template <typename Wanted>
  double volume(const Wanted& wanted) const {
    int count = 0;
    for (int s = 0; s < grid.size(); ++s) count += wanted(s) ? 1 : 0;
    return count * grid.volume();
  }
  double all() const { return grid.size() * grid.volume(); }
  double of_kind(TissueKind kind) const {
    return volume([&](int s) { return tissue.kind(s) == kind; });
  }
  double bone_of(BodyPart part) const {
    const int joint = body.find(part);
    return volume([&](int s) {
      return tissue.kind(s) == TissueKind::bone && tissue.bone_joint[static_cast<std::size_t>(s)] == joint;
    });
  }
};

constexpr std::array<std::pair<const char*, double>, 3> kFatOfHumans{
    {{"human_muscular", 0.13}, {"human_average", 0.2}, {"human_heavy", 0.32}}};

const std::map<std::string, Inside>& humans_inside() {
  static const std::map<std::string, Inside> insides = [] {
    std::map<std::string, Inside> made;
    for (const auto& [name, fat] : kFatOfHumans) {
      const auto path = shared_data("characters/" + std::string(name) + ".glb");
      if (path) made.emplace(name, Inside(read_character(*path), 0.005, fat));
    }
    return made;
  }();
  return insides;
}

class InsideOfHumans : public ::testing::Test {
 protected:
  void SetUp() override {
    if (humans_inside().size() < kFatOfHumans.size()) GTEST_SKIP() << kNeedsRealBodies;
  }
};

// The skeleton is 10.5 % of a body's volume (ICRP 89).
TEST_F(InsideOfHumans, BoneIsATenthOfTheBody) {
  for (const auto& [name, inside] : humans_inside()) {
    const double bone = inside.of_kind(TissueKind::bone) - inside.tissue.brain;
    EXPECT_GT(bone, 0.09 * inside.all()) << name;
    EXPECT_LT(bone, 0.13 * inside.all()) << name;
    EXPECT_NEAR(2e6 * inside.tissue.brain, 1300, 400) << name;
  }
}

TEST_F(InsideOfHumans, FatIsWhatWasAskedFor) {
  for (const auto& [name, fat] : kFatOfHumans) {
    const Inside& inside = humans_inside().at(name);
    const double subcutaneous = 0.8 * fat * 1.01 / 0.92 * inside.all();
    EXPECT_NEAR(inside.volume([&](int s) { return inside.tissue.fat[s] < 0; }), subcutaneous, 0.05 * subcutaneous)
        << name;
  }
}

// Square centimetres of muscle at the third lumbar vertebra.
TEST_F(InsideOfHumans, LoinHasTheMuscleOfASection) {
  const Inside& inside = humans_inside().at("human_muscular");
  const double height = inside.tissue.landmarks.at("iliac_crest").y() + 0.035, slab = 0.02;
  const double lean = inside.volume([&](int s) {
    const BodyRegion region = inside.tissue.region[static_cast<std::size_t>(s)];
    const bool is_trunk = region == BodyRegion::trunk || region == BodyRegion::hip;
    return is_trunk && std::abs(inside.grid.points(s, 1) - height) < slab / 2 &&
           inside.tissue.kind(s) == TissueKind::other_lean;
  });
  EXPECT_NEAR(2e4 * lean / slab, 180, 30);
}

TEST_F(InsideOfHumans, EveryBoneIsThereAndInsideTheBody) {
  for (const auto& [name, inside] : humans_inside()) {
    for (const BodyPart part : {BodyPart::hips, BodyPart::spine, BodyPart::head, BodyPart::thigh, BodyPart::shin,
                                BodyPart::foot, BodyPart::clavicle, BodyPart::upper_arm, BodyPart::forearm})
      EXPECT_GT(inside.bone_of(part), 50e-6) << name << " " << static_cast<int>(part);
    EXPECT_TRUE(inside.tissue.notes.empty()) << name << ": " << inside.tissue.notes.front();
    for (const auto& [landmark, place] : inside.tissue.landmarks) EXPECT_GE(place.x(), 0) << name << " " << landmark;
  }
}

TEST_F(InsideOfHumans, FinerGridTellsTheSame) {
  const Inside& coarse = humans_inside().at("human_muscular");
  const auto path = shared_data("characters/human_muscular.glb");
  const Inside fine(read_character(*path), 0.0035, 0.13);
  for (const TissueKind kind : {TissueKind::bone, TissueKind::fat, TissueKind::cavity})
    EXPECT_NEAR(coarse.of_kind(kind), fine.of_kind(kind), 0.02 * fine.of_kind(kind)) << name_of(kind);
}

TEST(InnerTissue, BonesOfAnEggLieInIt) {
  const Inside inside(egg_human(), 0.01, 0.15);
  EXPECT_GT(inside.bone_of(BodyPart::thigh), 200e-6);
  for (int s = 0; s < inside.grid.size(); ++s) {
    ASSERT_TRUE(inside.tissue.bone[s] >= 0 || inside.grid.depth[s] > 0.0015) << inside.grid.points.row(s);
    ASSERT_TRUE(std::isfinite(inside.tissue.bone[s]) && std::isfinite(inside.tissue.cavity[s]));
  }
}

// Without the joints of an arm and a leg, on one side.
TEST(InnerTissue, MissingLimbsAreSaid) {
  Character human = stand_in_human();
  for (Joint& joint : human.skeleton.joints) {
    for (const char* name : {"LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase", "LeftArm", "LeftForeArm", "LeftHand"}) {
      if (joint.name == name) joint.name = "rope" + std::to_string(&joint - human.skeleton.joints.data());
    }
  }
  const Inside inside(human, 0.012, 0.15);
  EXPECT_FALSE(inside.tissue.notes.empty());
  EXPECT_GT(inside.bone_of(BodyPart::hips), 200e-6) << "the pelvis is placed by the other leg";
}

TEST(InnerTissue, SixtyPercentOfFatFindRoom) {
  const Inside inside(stand_in_human(), 0.012, 0.6);
  const double subcutaneous = 0.8 * 0.6 * 1.01 / 0.92 * inside.all();
  EXPECT_NEAR(inside.volume([&](int s) { return inside.tissue.fat[s] < 0; }), subcutaneous, 0.05 * subcutaneous);
  EXPECT_GT(inside.bone_of(BodyPart::thigh), 100e-6);
}

}  // namespace
