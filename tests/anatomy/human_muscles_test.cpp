// Muscles of humans: as much of them in each limb as anatomists find, each of its volume, on any grid.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "runtime/core/error.h"
#include "tests/anatomy/tube_body.h"
#include "tests/support/error_kind.h"
#include "tests/support/shared_data.h"
#include "trainer/anatomy/anatomy_report.h"
#include "trainer/anatomy/muscle_candidates.h"
#include "trainer/muscle_models/fit.h"

namespace {

using namespace bodyopt;
using namespace bodyopt::trainer;
using bodyopt::testing::kind_of;

constexpr double kCoarse = 0.005;

struct DividedHuman {
  Character character;
  std::vector<Muscle> muscles;
  AnatomyField field;

  DividedHuman(const std::filesystem::path& path, double body_fat, double cell) : character(read_character(path)) {
    for (const auto& [model, mapping] : {std::pair("opensim/gait2392_thelen2003muscle.osim", "gait2392.json"),
                                         std::pair("myo_sim/arm/myoarm.xml", "myo_arm.json")}) {
      for (const muscle_models::FittedMuscle& fitted :
           fit_muscles(muscle_models::read_model(*shared_data(std::string("muscles/") + model)),
                       muscle_models::read_mapping(kSourceFolder + "/rigs/human/" + mapping), character)) {
        muscles.push_back(fitted.muscle);
      }
    }
    const TrunkMuscles trunk = trunk_muscles(character, muscles, body_fat);
    muscles.insert(muscles.end(), trunk.muscles.begin(), trunk.muscles.end());
    field = AnatomyField(character, muscles, {.body_fat = body_fat, .kind = BodyKind::biped, .cell = cell});
  }

  const InnerTissue& tissue() const { return field.halves().front().tissue; }
  const Division& division() const { return field.halves().front().division; }

  int samples(BodyRegion region) const { return static_cast<int>(std::ranges::count(tissue().region, region)); }
  int muscle_samples(BodyRegion region) const {
    int muscle = 0;
    for (std::size_t s = 0; s < division().label.size(); ++s) {
      muscle += tissue().region[s] == region && division().label[s] >= 0 && !division().is_tendon[s] ? 1 : 0;
    }
    return muscle;
  }
  int bone_samples(BodyPart part) const {
    const int joint = field.halves().front().body.find(part);
    int bone = 0;
    for (std::size_t s = 0; s < tissue().bone_joint.size(); ++s) {
      bone += tissue().bone[static_cast<Eigen::Index>(s)] < 0 && tissue().bone_joint[s] == joint ? 1 : 0;
    }
    return bone;
  }
  double muscle_share(BodyRegion region) const { return static_cast<double>(muscle_samples(region)) / samples(region); }
};

constexpr std::array<std::pair<const char*, double>, 3> kHumans{
    {{"human_muscular", 0.13}, {"human_average", 0.2}, {"human_heavy", 0.32}}};

const std::map<std::string, DividedHuman>& divided_humans() {
  static const std::map<std::string, DividedHuman> humans = [] {
    std::map<std::string, DividedHuman> made;
    for (const auto& [name, fat] : kHumans) {
      const auto path = shared_data("characters/" + std::string(name) + ".glb");
      if (path) made.emplace(name, DividedHuman(*path, fat, kCoarse));
    }
    return made;
  }();
  return humans;
}

class MusclesOfHumans : public ::testing::Test {
 protected:
  void SetUp() override {
    if (divided_humans().size() < kHumans.size()) GTEST_SKIP() << kNeedsRealBodies;
  }
};

TEST_F(MusclesOfHumans, LimbsAreAsMuchMuscleAsSectionsShow) {
  for (const auto& [name, human] : divided_humans()) {
    const auto expect = [&name = name, &human = human](BodyRegion region, double least, double most) {
      EXPECT_GT(human.muscle_share(region), least) << name << " " << name_of(region);
      EXPECT_LT(human.muscle_share(region), most) << name << " " << name_of(region);
    };
    expect(BodyRegion::thigh, 0.60, 0.75);
    expect(BodyRegion::upper_arm, 0.55, 0.77);
    expect(BodyRegion::calf, 0.45, 0.60);
    expect(BodyRegion::forearm, 0.45, 0.67);
  }
}

TEST_F(MusclesOfHumans, EachHasItsVolumeInOnePiece) {
  for (const auto& [name, human] : divided_humans()) {
    double sum = 0;
    int count = 0;
    for (const Division::OfMuscle& muscle : human.division().muscles) {
      const std::string& own = human.muscles[static_cast<std::size_t>(muscle.muscle)].name;
      EXPECT_EQ(muscle.pieces, 1) << name << " " << own;
      EXPECT_GT(muscle.volume, 0.2 * muscle.target) << name << " " << own;
      if (muscle.target < 20e-6) continue;
      sum += std::pow(muscle.volume / muscle.target - 1, 2);
      ++count;
    }
    EXPECT_GT(count, 60);
    EXPECT_LT(std::sqrt(sum / count), 0.08) << name;
  }
}

// 16 in young men, of muscle without its tendons (Maden-Wilkinson et al. 2014).
TEST_F(MusclesOfHumans, ThighIsThirteenFemursAndMore) {
  for (const auto& [name, human] : divided_humans()) {
    const double ratio =
        static_cast<double>(human.muscle_samples(BodyRegion::thigh)) / human.bone_samples(BodyPart::thigh);
    EXPECT_GT(ratio, 13) << name;
    EXPECT_LT(ratio, 18) << name;
  }
}

TEST_F(MusclesOfHumans, PathsEndOnTheirBonesOrAreToldToBeFar) {
  for (const auto& [name, human] : divided_humans()) {
    const AnatomyReport report = report_anatomy(human.character, human.muscles, human.field);
    std::string warnings;
    for (const std::string& warning : report.warnings) warnings += warning + "\n";
    for (const AnatomyReport::OfMuscle& muscle : report.muscles) {
      for (const std::size_t end : {0U, 1U}) {
        const double off = muscle.ends_off_bone[end];
        EXPECT_TRUE(off < 0.002 || off > 0.04) << name << " " << muscle.name << " " << off;
        const bool is_told =
            warnings.find(muscle.name + (end == 0 ? " (origin, " : " (insertion, ")) != std::string::npos;
        EXPECT_EQ(is_told, off > 0.002) << name << " " << muscle.name << " " << off;
      }
    }
  }
}

TEST_F(MusclesOfHumans, FibresAreUnitVectorsWhereMusclesAre) {
  const DividedHuman& human = divided_humans().at("human_muscular");
  for (std::size_t s = 0; s < human.division().label.size(); ++s) {
    const bool is_muscle = human.division().label[s] >= 0 && !human.division().is_tendon[s];
    ASSERT_NEAR(human.division().fibre.row(static_cast<Eigen::Index>(s)).norm(), is_muscle ? 1 : 0, 1e-9) << s;
  }
}

TEST_F(MusclesOfHumans, FinerGridTellsTheSame) {
  const DividedHuman& coarse = divided_humans().at("human_muscular");
  const DividedHuman fine(*shared_data("characters/human_muscular.glb"), 0.13, 0.0035);
  ASSERT_EQ(fine.division().muscles.size(), coarse.division().muscles.size());
  double sum = 0;
  int count = 0;
  for (std::size_t m = 0; m < fine.division().muscles.size(); ++m) {
    if (coarse.division().muscles[m].target < 20e-6) continue;
    sum += std::pow(fine.division().muscles[m].volume / coarse.division().muscles[m].volume - 1, 2);
    ++count;
  }
  EXPECT_LT(std::sqrt(sum / count), 0.08);
}

TEST_F(MusclesOfHumans, TrunkMusclesComeInPairsAndOnce) {
  const DividedHuman& human = divided_humans().at("human_average");
  const TrunkMuscles trunk = trunk_muscles(human.character, {});
  EXPECT_TRUE(trunk.notes.empty());
  ASSERT_GT(trunk.muscles.size(), 20u);
  for (std::size_t k = 0; k < trunk.muscles.size(); k += 2) {
    const Muscle &left = trunk.muscles[k], &right = trunk.muscles[k + 1];
    EXPECT_EQ(left.name.substr(0, left.name.size() - 2), right.name.substr(0, right.name.size() - 2));
    EXPECT_EQ(left.radius, right.radius);
    for (std::size_t p = 0; p < left.path.size(); ++p) {
      EXPECT_GT(left.path[p].position[0], 0);
      EXPECT_NEAR(left.path[p].position[0], -right.path[p].position[0], 1e-5);
    }
  }
  EXPECT_TRUE(trunk_muscles(human.character, trunk.muscles).muscles.empty()) << "all are there already";
}

TEST(TrunkMusclesOfAnimals, AreRefused) {
  EXPECT_EQ(kind_of([] { trunk_muscles(snake_body(), {}); }), ErrorKind::mismatch);
}

}  // namespace
