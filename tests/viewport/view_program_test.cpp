// What `bodyopt view` opens, without a window.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/gpu_fixture.h"
#include "tests/support/limb_glb.h"
#include "tests/support/png_file.h"
#include "tests/support/run_verb.h"
#include "tests/viewport/small_character.h"

namespace bodyopt::testing {
namespace {

using namespace draw;

class ViewProgramTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { test_device(); }  // the driver, for the programs

  ProgramResult view(const std::string& arguments) const {
    const char* device = std::getenv("BODYOPT_TEST_DEVICE");
    return run_verb("view --size 160 90 --headless " + arguments + (device ? " --device " + std::string(device) : ""));
  }
  Image picture(const std::string& arguments) const {
    const ProgramResult result = view(arguments + " -o " + path("a.png"));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return read_png(path("a.png"));
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void expect(const ProgramResult& result, int exit_code, const std::string& named) const {
    EXPECT_EQ(result.exit_code, exit_code) << result.output;
    EXPECT_NE(result.output.find(named), std::string::npos) << "expected '" << named << "' in:\n" << result.output;
  }

  TemporaryFolder folder_;
  SmallCharacter small_{folder_};
};

TEST_F(ViewProgramTest, ACharacterIsShownWithoutTraining) {
  write_character(limb_character(), path("limb.glb"));
  Clip clip;
  clip.name = "bend";
  for (int k = 0; k < 5; ++k) clip.poses.push_back(limb_pose(limb_character().skeleton, 0.3 * k, 0, 0));
  write_clip(clip, limb_character().skeleton, path("bend.glb"));
  const std::string shown = path("limb.glb") + " " + path("bend.glb");
  const Image bent = picture(shown + " --cf 5");
  expect(view(shown + " -o " + path("a.png")), 0, "not trained");
  EXPECT_GT(spot_difference(bent, picture(shown + " --cf 1")).mean, 0.3);
  // The same as of a basis that was made before; and its weights are at hand.
  const ProgramResult made = run_verb("train --ddm-only " + path("limb.glb") + " --out " + path("limb.safetensors"));
  ASSERT_EQ(made.exit_code, 0) << made.output;
  EXPECT_TRUE(bent.rgba == picture(path("limb.safetensors") + " " + path("bend.glb") + " --cf 5").rgba);
  EXPECT_GT(spot_difference(bent, picture(shown + " --cf 5 --do 'compare lbs; heat on; heat-scale 1'")).mean, 0.3);
  std::filesystem::remove(path("limb.safetensors"));
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    EXPECT_NE(entry.path().filename().string()[0], '.') << entry;
    EXPECT_EQ(entry.path().string().find("limb.attached"), std::string::npos) << entry;
  }
}

TEST_F(ViewProgramTest, APinOutOfReachIsSaidWithoutAWindow) {
  write_character(limb_character(), path("limb.glb"));
  const std::string pinned = path("limb.glb") + " -o " + path("a.####.png") + " --do 'in 3; out 5; pin joint2 0 9 0'";
  const ProgramResult result = view(pinned);
  expect(result, 0, "frame 3: joint2: ");
  expect(result, 0, " mm from its pin, out of reach");
  EXPECT_EQ(result.output.find("joint2: "), result.output.rfind("joint2: ")) << "once, not of every picture";
  expect(view(path("limb.glb") + " --do 'pin joint2 0 9 0; screenshot " + path("b.png") + "; quit'"), 0,
         "frame 1: joint2: ");
}

TEST_F(ViewProgramTest, AJointMapTellsWhatMovesTheFirstCharacter) {
  Skeleton renamed = small_.made.skeleton;
  for (Joint& joint : renamed.joints) joint.name = "bone_" + joint.name;
  write_clip(bending_clip(small_.made.skeleton), renamed, path("renamed.glb"));
  std::string joints;
  for (const Joint& joint : small_.made.skeleton.joints) {
    joints += std::string(joints.empty() ? "" : ",") + R"({"from": "bone_)" + joint.name + R"(", "to": ")" +
              joint.name + "\"}";
  }
  std::ofstream(path("map.json")) << R"({"schema": "bodyopt-joint-map-1", "joints": [)" << joints << "]}";
  const std::string shown = small_.basis + " " + path("renamed.glb") + " --cf 9";
  expect(view(shown + " -o " + path("a.png")), 3, "moves no joint");
  const Image mapped = picture(shown + " --joint-map " + path("map.json"));
  EXPECT_TRUE(mapped.rgba == picture(small_.basis + " " + small_.clip + " --cf 9").rgba);
  std::ofstream(path("map.json")) << R"({"schema": "bodyopt-joint-map-1", "joints": [{"from": "x", "to": "y"}]})";
  expect(view(shown + " -o " + path("a.png") + " --joint-map " + path("map.json")), 3, "'x'");
}

TEST_F(ViewProgramTest, WithoutAFileItIsTheBuiltInArm) {
  const Image rest = picture("");
  expect(view("-o " + path("a.png")), 0, "bodyopt demo --out demo");
  EXPECT_GT(spot_difference(rest, picture("--cf 60")).mean, 0.3);
  EXPECT_GT(spot_difference(rest, picture("--do 'fibres on'")).mean, 0.1);
}

TEST_F(ViewProgramTest, TheTruthIsThatOfTheFirstCharacter) {
  write_character(limb_character(), path("limb.glb"));  // of other vertices than the small one
  const std::string two = small_.basis + " " + small_.clip + " " + path("limb.glb");
  const std::string script = " --do 'heat on; heat-scale 4'";
  const Image without = picture(two + script), with = picture(two + " --truth " + small_.truth + script);
  EXPECT_GT(spot_difference(without, with).mean, 0.3);
  // Behind another basis a cache is that one's.
  expect(view(two + " " + small_.truth + " -o " + path("a.png")), 3, "truth.pc2");
}

TEST_F(ViewProgramTest, AScriptChoosesTheLeadAndTakesOthersOffTheStage) {
  write_character(limb_character(), path("limb.glb"));
  const Image alone = picture(path("limb.glb"));
  const std::string two = small_.basis + " " + small_.clip + " " + path("limb.glb");
  EXPECT_GT(spot_difference(picture(two), alone).mean, 0.3);
  EXPECT_TRUE(picture(two + " --do 'lead 2; remove 1; frame-selection'").rgba == alone.rgba);
  EXPECT_TRUE(picture(two + " --do 'remove 1'").rgba == alone.rgba);
  expect(view(two + " --do 'lead 3' -o " + path("a.png")), 64, "expected one of 1, 2");
  expect(view(small_.basis + " --do 'remove 1' -o " + path("a.png")), 64, "the only character");
}

TEST_F(ViewProgramTest, ATruthThatLiesOtherwiseOnTheClipIsSaidOnce) {
  const std::string shown = small_.basis + " " + small_.clip + " -o " + path("a.####.png");
  const std::string said = "12 samples, of frames 1-12; the clip has frames 1-23 at 48 a second";
  const ProgramResult twice = view(shown + " --fps 48 --truth " + small_.truth);
  expect(twice, 0, said);
  EXPECT_EQ(twice.output.find(said), twice.output.rfind(said)) << twice.output;
  for (const std::string& fits : {shown + " --truth " + small_.truth, shown + " " + small_.truth}) {
    EXPECT_EQ(view(fits).output.find("samples"), std::string::npos);
  }
}

TEST_F(ViewProgramTest, WithoutAWindowSomethingIsToBeWritten) {
  const std::string shown = small_.basis + " " + small_.clip;
  expect(view(shown), 64, "-o FILE.png");
  expect(view(shown + " --do 'frame 3; wire on'"), 64, "screenshot");
  expect(view(shown + " --do 'frame 3; screenshot " + path("b.png") + "'"), 0, "");
  EXPECT_TRUE(std::filesystem::exists(path("b.png")));
}

TEST_F(ViewProgramTest, WhatIsNoCharacterIsNamed) {
  std::ofstream(path("hero.blend")) << "BLENDER-v300";
  expect(view(path("hero.blend") + " -o " + path("a.png")), 64, "a Blender file");
  std::ofstream(path("hero.fbx")) << "Kaydara FBX Binary  ";
  expect(view(path("hero.fbx") + " -o " + path("a.png")), 4, "the FBX file is cut off");
}

TEST_F(ViewProgramTest, FramesThatTheClipLacksAreRefused) {
  const std::string shown = small_.basis + " " + small_.clip + " -o " + path("a.png");  // frames 1 to 12
  for (const char* asked : {"--cf 13", "--cf 0", "--ff 13", "--lf 2000", "--do 'frame 2000'"}) {
    expect(view(shown + " " + asked), 64, "frames 1-12");
  }
}

TEST_F(ViewProgramTest, PicturesOfOtherKindsAreRefused) {
  for (const char* file : {"z.jpg", "z", "z.####.tif"}) {
    expect(view("missing.safetensors -o " + path(file)), 64, ".webp");
  }
}

TEST_F(ViewProgramTest, WhatCannotBeShownEndsAScript) {
  const std::string shown = small_.basis + " " + small_.clip + " -o " + path("a.png");
  expect(view(shown + " --do 'compare lbs'"), 64, "--character");
  expect(view(shown + " --do 'jiggle on'"), 64, "bodyopt dynamics");
}

TEST_F(ViewProgramTest, WhatDoesNotGoWithAnOptionIsSaid) {
  const std::string shown = small_.basis + " " + small_.clip + " -o " + path("a.png");
  expect(view(shown + " --proxy " + small_.basis), 3, "'bodyopt proxy' makes them");
  for (const char* port : {"99999", "-1", "x"}) expect(view(shown + " --live " + port), 64, "--live");
  expect(view(shown + " --live 99999"), 64, "65535");
}

TEST_F(ViewProgramTest, PicturesAreAsLargeAsScreensAre) {
  const std::string shown = small_.basis + " " + small_.clip + " --headless -o " + path("a.png");
  const ProgramResult result = run_verb("view --size 3840 60 " + shown);
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(read_png(path("a.png")).width, 3840u);
  EXPECT_EQ(run_verb("view --size 8193 60 " + shown).exit_code, 64);
}

}  // namespace
}  // namespace bodyopt::testing
