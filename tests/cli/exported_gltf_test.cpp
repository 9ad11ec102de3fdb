// Every .glb we write passes Khronos' gltf-validator.
#include <gtest/gtest.h>

#include "tests/support/paths.h"
#include "tests/support/run_program.h"
#include "tests/support/run_verb.h"
#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"
#include "trainer/builtin/arm.h"
#include "trainer/motion/range_of_motion.h"

namespace bodyopt {
namespace {

using namespace trainer;

void expect_valid(const std::filesystem::path& folder) {
  const std::string modules = kSourceFolder + "/build/npm/node_modules";
  if (run_program("npm --version").exit_code != 0 || !std::filesystem::exists(modules + "/gltf-validator")) {
    GTEST_SKIP() << "npm or gltf-validator is not installed (scripts/test installs the validator where npm is)";
  }
  const ProgramResult result = run_program("node " + kSourceFolder + "/tests/other_programs/validate_gltf.mjs " +
                                           modules + " " + folder.string() + "/*.glb");
  EXPECT_EQ(result.exit_code, 0) << result.output;
}

TEST(ExportedGltf, BuiltinCharacterAndClipsAreValid) {
  const TemporaryFolder folder;
  const BuiltinArm arm = build_arm();
  const Skeleton& skeleton = arm.character.skeleton;
  write_character(arm.character, folder / "character.glb");
  const JointLimits limits = arm_limits(skeleton);
  const RangeOfMotion motion = range_of_motion(arm.character, limits, {.frames = 24});
  write_clip(clip_of(motion, limits, skeleton), skeleton, folder / "rom.glb");
  write_clip(arm_heldout(skeleton, 24), skeleton, folder / "heldout.glb");
  expect_valid(folder.path());
  expect_valid(kSourceFolder + "/rigs/arm");
}

TEST(ExportedGltf, ShapesAndRigsAreValid) {
  const TemporaryFolder folder;
  const std::string arm = kSourceFolder + "/rigs/arm/arm.glb", basis = (folder / "arm.safetensors").string();
  write_clip(arm_heldout(read_character(arm).skeleton, 24), read_character(arm).skeleton, folder / "heldout.glb");
  EXPECT_EQ(run_verb("train --ddm-only " + arm + " --out " + basis).exit_code, 0);
  for (const std::string form : {"shapes.glb", "rig.glb --rigged"}) {
    const ProgramResult ran =
        run_verb("eval " + basis + " --device cpu --frames 3-6 --clip " + (folder / "heldout.glb").string() +
                 " --character " + arm + " --out " + (folder / form).string());
    EXPECT_EQ(ran.exit_code, 0) << ran.output;
  }
  expect_valid(folder.path());
}

TEST(ExportedGltf, CharactersReadFromElsewhereAreValidWhenWritten) {
  const TemporaryFolder folder;
  for (const char* name : {"human_163_joints", "cesium_man", "greenman"}) {
    const auto path = shared_data(std::string("characters/") + name + ".glb");
    if (!path) GTEST_SKIP() << kNeedsOtherWriters;
    write_character(read_character(*path), folder / (std::string(name) + ".glb"));
  }
  expect_valid(folder.path());
}

}  // namespace
}  // namespace bodyopt
