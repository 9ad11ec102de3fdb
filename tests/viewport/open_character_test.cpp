#include "shots/shot_files.h"
#include "tests/builtin/shared_arm.h"
#include "tests/support/error_kind.h"
#include "tests/support/limb_glb.h"
#include "tests/support/same_basis.h"
#include "tests/support/shared_data.h"
#include "tests/viewport/small_character.h"
#include "trainer/train/features/features.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::testing {
namespace {

using namespace trainer;
using namespace shots;

std::size_t count_files(const TemporaryFolder& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder.path()), {}));
}

TEST(OpenCharacter, ACharacterIsDirectDeltaMushWithItsOwnClipAndMeshes) {
  const TemporaryFolder folder;
  const std::string path = limb_file(folder, true);
  const OpenedCharacter opened = open_character(path, {.fps = 10});
  ASSERT_EQ(opened.levels.size(), 1u);
  EXPECT_EQ(difference(opened.levels[0].basis, build_ddm_basis(read_character(path), {})), "");
  ASSERT_TRUE(opened.clip);
  EXPECT_EQ(opened.clip->name, "nod");
  EXPECT_EQ(opened.clip->poses.size(), 11u);
  ASSERT_EQ(opened.attached.meshes.size(), 1u);
  EXPECT_EQ(opened.attached.meshes[0].name, "eye");
  ASSERT_TRUE(opened.character);
  EXPECT_EQ(opened.character->output_count(), opened.levels[0].basis.mesh.output_count());
  EXPECT_NE(opened.shown_by.find("not trained"), std::string::npos);
  EXPECT_EQ(count_files(folder), 1u);
}

TEST(OpenCharacter, ItsUnitIsThatOfItsClipsAndMeshes) {
  const TemporaryFolder folder;
  const OpenedCharacter opened = open_character(limb_file(folder, true), {.unit = 0.5});
  EXPECT_EQ(opened.levels[0].basis.metadata.at("character_unit_m"), "0.5");
  EXPECT_NEAR(opened.attached.meshes[0].rest[2], 0.26, 0.01);
  EXPECT_NEAR(opened.clip->poses[0].joints[1].translation[2], 0.15, 1e-6);
}

// Whose file is in centimetres, and `open` is told no unit.
TEST(OpenCharacter, AUnitThatItsSizeTellsIsThatOfItsClips) {
  const auto path = shared_data("characters/fox.glb");
  if (!path) GTEST_SKIP() << kNeedsOtherWriters;
  const OpenedCharacter found = open_character(*path, {}), told = open_character(*path, {.unit = 0.01});
  EXPECT_EQ(found.levels[0].basis.metadata, told.levels[0].basis.metadata);
  EXPECT_EQ(difference(found.levels[0].basis, told.levels[0].basis), "");
  ASSERT_TRUE(found.clip && told.clip);
  for (std::size_t j = 0; j < told.clip->poses[0].joints.size(); ++j) {
    EXPECT_EQ(found.clip->poses[0].joints[j].translation, told.clip->poses[0].joints[j].translation);
  }
  EXPECT_TRUE(mentions(found.notes, "a unit is taken as 0.01 m"));
}

TEST(OpenCharacter, WithoutAClipThereIsNone) {
  const TemporaryFolder folder;
  EXPECT_FALSE(open_character(limb_file(folder, false), {}).clip);
  EXPECT_EQ(kind_of([&] { open_character((folder / "none.glb").string(), {}); }), ErrorKind::file);
}

TEST(OpenCharacter, NothingIsTheBuiltInArmWithItsMusclesAndMotion) {
  const OpenedCharacter opened = open_character("", {});
  const Basis& basis = opened.levels.at(0).basis;
  validate(basis, "the arm");
  EXPECT_EQ(basis.mesh.rest.size(), static_cast<std::size_t>(arm().character.vertices.size()));
  EXPECT_EQ(fibre_muscles(basis.strain, arm().muscles).size(), basis.strain.fibre_count());
  EXPECT_GT(basis.strain.fibre_count(), arm().muscles.size());
  ASSERT_TRUE(opened.clip);
  EXPECT_EQ(opened.clip->poses.size(), 144u);
  EXPECT_NE(opened.shown_by.find("bodyopt demo --out demo"), std::string::npos);
  // Its strains are measured, although nothing is learned from them.
  Deformer deformer(basis, {.name = "cpu"});
  const Evaluation bent = deformer.evaluate({&opened.clip->poses[60], 1});
  EXPECT_GT(*std::max_element(bent.strains.begin(), bent.strains.end()), 0.05f);
}

TEST(OpenCharacter, ABasisIsReadAsItIs) {
  const TemporaryFolder folder;
  const SmallCharacter small(folder);
  const OpenedCharacter opened = open_character(small.basis, {});
  EXPECT_EQ(difference(opened.levels.at(0).basis, small.made), "");
  EXPECT_FALSE(opened.character);
  EXPECT_FALSE(opened.clip);
  EXPECT_TRUE(opened.notes.empty());
}

TEST(OpenCharacter, AnotherCharacterIsOneThatIsNoClipOfThisSkeleton) {
  const TemporaryFolder folder;
  const SmallCharacter small(folder);
  const Skeleton own = limb_character().skeleton;
  EXPECT_TRUE(is_another_character(limb_file(folder, true), small.made.skeleton));
  EXPECT_FALSE(is_another_character(limb_file(folder, true), own));
  EXPECT_FALSE(is_another_character((folder / "limb.glb#nod").string(), small.made.skeleton));
  EXPECT_TRUE(is_another_character(limb_file(folder, false), own));
  EXPECT_FALSE(is_another_character(small.clip, own));  // has no skin
}

// The first joints of the limb, by their names, and others.
Skeleton with_shared_joints(std::size_t shared, std::size_t all) {
  const Skeleton own = limb_character().skeleton;
  Skeleton skeleton;
  for (std::size_t k = 0; k < all; ++k) {
    Joint joint;
    joint.name = k < shared ? own.joints[k].name : "other" + std::to_string(k);
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

TEST(OpenCharacter, AFewJointsOfTheSameNameMakeNoClip) {
  const TemporaryFolder folder;
  const std::string file = limb_file(folder, true);
  ASSERT_EQ(limb_character().skeleton.size(), 3u);
  EXPECT_TRUE(is_another_character(file, with_shared_joints(1, 40)));
  EXPECT_TRUE(is_another_character(file, with_shared_joints(1, 3)));
  EXPECT_FALSE(is_another_character(file, with_shared_joints(2, 3)));
  EXPECT_FALSE(is_another_character(file, with_shared_joints(3, 40)));  // all that the file has
  EXPECT_FALSE(is_another_character(file, with_shared_joints(1, 2)));   // half of all that the character has
}

}  // namespace
}  // namespace bodyopt::testing
