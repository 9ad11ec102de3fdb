// The program as a user meets it: exit codes and messages.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"
#include "trainer/builtin/arm.h"
#include "trainer/dataset/pc2.h"

namespace bodyopt {
namespace {

TEST(Program, HelpOfEveryVerbExitsWithZero) {
  EXPECT_EQ(run_bodyopt("--help").exit_code, 0);
  for (const char* verb : {"demo", "muscles import", "rom", "simulate", "export", "check", "train", "eval", "compare",
                           "picture", "info", "devices"}) {
    const ProgramResult result = run_bodyopt(std::string(verb) + " --help");
    EXPECT_EQ(result.exit_code, 0) << verb;
    EXPECT_NE(result.output.find("--json"), std::string::npos) << verb;
  }
}

TEST(Program, WrongArgumentsExitWith64) {
  EXPECT_EQ(run_bodyopt("").exit_code, 64);
  EXPECT_EQ(run_bodyopt("frobnicate").exit_code, 64);
  EXPECT_EQ(run_bodyopt("eval").exit_code, 64);
  EXPECT_EQ(run_bodyopt("compare a.pc2 b.pc2 --fail-above minus").exit_code, 64);
  EXPECT_EQ(run_bodyopt("train --out x.safetensors").exit_code, 64);
}

TEST(Program, MissingFilesExitWith4AndAreNamed) {
  for (const char* command :
       {"info nowhere.glb", "info nowhere.pc2", "check nowhere/dataset.json", "export nowhere.nodes --out b.pc2",
        "eval nowhere.safetensors --clip a.glb --out b.pc2 --device cpu", "train nowhere --out b.safetensors",
        "compare nowhere.pc2 nowhere.pc2", "picture nowhere --frame 1 --out p.png",
        "muscles import nowhere.glb --from a.osim b.json --out m.json"}) {
    const ProgramResult result = run_bodyopt(command);
    EXPECT_EQ(result.exit_code, 4) << command << "\n" << result.output;
    EXPECT_NE(result.output.find("nowhere"), std::string::npos) << command;
  }
}

TEST(Program, CompareMeasuresAndFailsAboveTheLimit) {
  const TemporaryFolder folder;
  const std::vector<float> rest = {0, 0, 0, 1, 0, 0}, moved = {0, 0, 0, 1.003f, 0, 0};
  for (const auto& [name, sample] : {std::pair("a.pc2", rest), std::pair("b.pc2", moved)}) {
    Pc2Writer writer(folder / name, 2, 1);
    writer.append(sample);
    writer.close();
  }
  const std::string caches = (folder / "a.pc2").string() + " " + (folder / "b.pc2").string();
  EXPECT_EQ(run_bodyopt("compare " + caches + " --fail-above 3.1").exit_code, 0);
  const ProgramResult failed = run_bodyopt("compare " + caches + " --fail-above 2.9 --json -");
  EXPECT_EQ(failed.exit_code, 2);
  EXPECT_NE(failed.output.find("\"worst_vertex\": 1"), std::string::npos) << failed.output;
}

TEST(Program, UntrainedBasisOfTheBuiltinArmEvaluatesOnTheCpu) {
  const TemporaryFolder folder;
  const BuiltinArm arm = build_arm();
  const std::string character = (folder / "arm.glb").string(), clip = (folder / "clip.glb").string();
  const std::string basis = (folder / "arm.safetensors").string(), cache = (folder / "out.pc2").string();
  write_character(arm.character, character);
  write_clip(arm_heldout(arm.character.skeleton, 10), arm.character.skeleton, clip);

  ProgramResult result = run_bodyopt("train --ddm-only " + character + " --out " + basis);
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(run_bodyopt("info " + basis).exit_code, 0);
  result = run_bodyopt("eval " + basis + " --clip " + clip + " --frames 1-9x2 --device cpu --out " + cache);
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const Pc2Reader reader(cache);
  EXPECT_EQ(reader.sample_count(), 5u);
  EXPECT_EQ(reader.point_count(), arm.character.output_count());
  EXPECT_EQ(reader.start_frame(), 1);
  EXPECT_EQ(reader.sample_rate(), 2);  // every second frame
  // Nothing was learned that could cover anything.
  EXPECT_EQ(run_bodyopt("coverage " + basis + " --clip " + clip).exit_code, 3);
  // A slip that would write over the character.
  EXPECT_EQ(run_bodyopt("eval " + basis + " --clip " + clip + " --device cpu --out " + character).exit_code, 64);
  EXPECT_EQ(run_bodyopt("info " + character).exit_code, 0);

  EXPECT_EQ(run_bodyopt("eval " + basis + " --clip " + clip + " --frames 5-99 --device cpu --out " + cache).exit_code,
            64);
  EXPECT_EQ(run_bodyopt("eval " + basis + " --clip " + clip + " --device nosuch --out " + cache).exit_code, 5);
  EXPECT_EQ(run_bodyopt("eval " + basis + " --clip " + clip + " --device cpu --out /nonexistent/x.pc2").exit_code, 4);

  // Half a basis is refused, and the cache of the earlier run is left as it was.
  std::filesystem::resize_file(basis, std::filesystem::file_size(basis) / 2);
  EXPECT_EQ(run_bodyopt("eval " + basis + " --clip " + clip + " --device cpu --out " + cache).exit_code, 4);
  EXPECT_EQ(Pc2Reader(cache).sample_count(), 5u);
}

}  // namespace
}  // namespace bodyopt
