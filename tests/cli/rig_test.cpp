// From a character alone to what rom, dynamics and train can use.
#include "runtime/host/rig.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "assets/clips/clip.h"
#include "base/json_file.h"
#include "dataset/dataset.h"
#include "tests/cli/limb_files.h"
#include "tests/support/detached_limb.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/run_verb.h"

namespace bodyopt {
namespace {

TEST(RigVerb, WritesWhatTheOtherVerbsRead) {
  const TemporaryFolder folder;
  const LimbFiles limb(folder, 100);
  const std::string rig = (folder / "rig").string(), rom = (folder / "rom.glb").string(), unit = " --unit 0.01";
  const ProgramResult made = run_verb("rig " + limb.character + unit + " --clip " + limb.motion + " --out " + rig);
  ASSERT_EQ(made.exit_code, 0) << made.output;
  EXPECT_NE(made.output.find("no mapping of muscles"), std::string::npos) << made.output;
  const Json limits = read_json(rig + "/limits.json", "bodyopt-joint-limits-1");
  for (const Json& dof : limits.at("dofs")) EXPECT_FALSE(dof.at("source").get<std::string>().empty());
  EXPECT_FALSE(read_json(rig + "/regions.json", "bodyopt-regions-1").at("source").get<std::string>().empty());

  const ProgramResult motion =
      run_verb("rom " + limb.character + unit + " --limits " + rig + "/limits.json --frames 60 --out " + rom);
  EXPECT_EQ(motion.exit_code, 0) << motion.output;
  const std::string basis = (folder / "limb.safetensors").string();
  ASSERT_EQ(run_verb("train --ddm-only " + limb.character + unit + " --out " + basis).exit_code, 0);
  const ProgramResult dynamics = run_verb("dynamics " + limb.character + " --basis " + basis + " --jiggle " + rig +
                                          "/jiggle.json --out " + (folder / "limb.dynamics.safetensors").string());
  EXPECT_EQ(dynamics.exit_code, 0) << dynamics.output;
}

// As of a run that was cut off: what is missing is added, what was edited stays, and is said.
TEST(RigVerb, FinishesWhatWasCutOffAndKeepsWhatWasEdited) {
  const TemporaryFolder folder;
  const LimbFiles limb(folder, 1);
  const std::string verb = "rig " + limb.character + " --out " + (folder / "rig").string();
  const std::filesystem::path limits = folder / "rig/limits.json", regions = folder / "rig/regions.json";
  ASSERT_EQ(run_verb(verb).exit_code, 0);
  const std::string whole = testing::read_bytes(regions);
  std::filesystem::remove(regions);
  EXPECT_EQ(run_verb(verb).exit_code, 0);
  EXPECT_EQ(testing::read_bytes(regions), whole);
  const std::string edited = testing::read_bytes(limits) + "\n";
  testing::write_bytes(limits, edited);
  std::filesystem::remove(regions);
  const ProgramResult refused = run_verb(verb);
  EXPECT_EQ(refused.exit_code, 64);
  EXPECT_NE(refused.output.find("limits.json: is there already"), std::string::npos) << refused.output;
  EXPECT_EQ(refused.output.find("dynamics"), std::string::npos) << "found after long work: " << refused.output;
  EXPECT_EQ(testing::read_bytes(limits), edited);
  EXPECT_FALSE(std::filesystem::exists(regions));
}

// The clip has it at the end of its leg, where the leg's skin goes on in that of the foot.
TEST(RomVerb, AFootUnderTheRootFollowsItsLeg) {
  const TemporaryFolder folder;
  const Character character = detached_limb();
  const std::string file = (folder / "limb.glb").string(), rig = (folder / "rig").string(),
                    rom = (folder / "rom.glb").string();
  write_character(character, file);
  const ProgramResult made = run_verb("rig " + file + " --out " + rig);
  ASSERT_EQ(made.exit_code, 0) << made.output;
  EXPECT_NE(made.output.find("'joint2' follows 'joint1'"), std::string::npos) << made.output;
  ASSERT_EQ(run_verb("rom " + file + " --limits " + rig + "/limits.json --frames 40 --out " + rom).exit_code, 0);
  double farthest = 0;
  for (const Pose& pose : read_clip(rom, character.skeleton, {}).poses) {
    const std::vector<Affine> world = posed_joints(character.skeleton, pose.joints);
    const Vec3 foot = world[1] * Vec3{0, 0, 0};
    EXPECT_LT(length(foot - world[3] * Vec3{0, 0, 0.2}), 1e-5);
    farthest = std::max(farthest, length(foot - Vec3{0, 0, 0.5}));
  }
  EXPECT_GT(farthest, 0.02);
}

TEST(RomVerb, NeedsNoLimitsWithClips) {
  const TemporaryFolder folder;
  const LimbFiles limb(folder, 1);
  const std::string rom = "rom " + limb.character + " --frames 40 --out " + (folder / "rom.glb").string();
  EXPECT_EQ(run_verb(rom + " --from " + limb.motion).exit_code, 0);
  const ProgramResult none = run_verb(rom);
  EXPECT_EQ(none.exit_code, 64);
  EXPECT_NE(none.output.find("bodyopt rig"), std::string::npos) << none.output;
}

// Before the character is read, which is not there.
TEST(RigVerb, AnOutputThatCannotBeWrittenIsSaidFirst) {
  const TemporaryFolder folder;
  const std::string file = (folder / "file").string(), nowhere = (folder / "no/r.glb").string();
  testing::write_bytes(file, "");
  for (const auto& [command, named] :
       {std::pair("rig none.glb --out " + file + "/rig", file + ": cannot be written into"),
        {"rom none.glb --limits limits.json --out " + nowhere, nowhere + ": cannot be created"}}) {
    const ProgramResult refused = run_verb(command);
    EXPECT_EQ(refused.exit_code, 4) << refused.output;
    EXPECT_NE(refused.output.find(named), std::string::npos) << refused.output;
  }
}

}  // namespace
}  // namespace bodyopt
