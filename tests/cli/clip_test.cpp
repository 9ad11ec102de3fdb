// What is said of clips, and joint maps, on the command line.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "assets/caches/pc2.h"
#include "assets/clips/bvh_clip.h"
#include "cli/arguments/common.h"
#include "dataset/dataset.h"
#include "runtime/core/json.h"
#include "tests/cli/limb_files.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/run_verb.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt {
namespace clip_program_test {

using namespace trainer;

using testing::write_bytes;

// The limb, a clip that bends it, one whose joints have other names, one that twists it all the time; a map and limits.
class ClipProgram : public ::testing::Test {
 protected:
  ClipProgram() : files_(folder_, 1), limb_(read_character(files_.character)) {
    Clip clip = read_clip(files_.motion, limb_.skeleton, {});
    Skeleton renamed = limb_.skeleton;
    renamed.joints[0].name = "bone_a";
    renamed.joints[1].name = "bone_b";
    write_clip(clip, renamed, folder_ / "renamed.glb");
    for (Pose& pose : clip.poses)
      pose.joints[1].rotation = pose.joints[1].rotation * axis_angle({1, 0, 0}, degrees(45));
    write_clip(clip, limb_.skeleton, folder_ / "twisted.glb");
    put_map(R"([{"from": "bone_a", "to": "upper"}, {"from": "bone_b", "to": "lower"}])");
    write_bytes(folder_ / "limits.json", R"({"schema": "bodyopt-joint-limits-1", "dofs": [{"name": "elbow", "rest": 0,
        "min": -10, "max": 120, "turns": [{"joint": "lower", "axis": [0, 0, 1]}]}]})");
  }

  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  void put_map(const std::string& joints) const {
    write_bytes(folder_ / "map.json", R"({"schema": "bodyopt-joint-map-1", "joints": )" + joints + "}");
  }
  void expect(const std::string& arguments, int exit_code, const std::string& named) const {
    const ProgramResult result = run_verb(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << arguments << "\n" << result.output;
    EXPECT_NE(result.output.find(named), std::string::npos) << "expected '" << named << "' in:\n" << result.output;
  }

  TemporaryFolder folder_;
  LimbFiles files_;
  Character limb_;
};

TEST_F(ClipProgram, CheckSaysWhatAClipHoldsBeyondTheLimits) {
  const std::string check = "check " + files_.character + " --clip ", limits = " --limits " + at("limits.json");
  expect(check + at("twisted.glb") + limits, 0, "PROBLEM: 'lower' is turned by 45 degrees about the left-right axis");
  expect(check + files_.motion + limits, 0, "no joint is held beyond its limits");
  expect(check + files_.motion, 0, "bend: 6 frames");
  expect(check + at("twisted.glb") + limits + " --frames 2", 0, "in the only frame");
  const ProgramResult json = run_verb(check + at("twisted.glb") + limits + " --json -");
  const Json result = Json::parse(json.output);
  ASSERT_EQ(result.at("held_beyond_limits").size(), 1u);
  EXPECT_EQ(result["held_beyond_limits"][0]["joint"], "lower");
  EXPECT_NEAR(result["held_beyond_limits"][0]["degrees"], 45, 1e-3);
  EXPECT_EQ(result["held_beyond_limits"][0]["share_of_frames"], 1);
  EXPECT_EQ(result["frames"], 6);

  expect("check " + files_.character + limits, 64, "--clip");
  expect("check " + files_.character + " --joint-map " + at("map.json"), 64, "--clip");
  expect("check " + at("") + " --clip " + files_.motion, 64, "not a dataset");
  expect(check + at("renamed.glb"), 3, "moves no joint of the character");
  expect(check + at("renamed.glb") + " --joint-map " + at("map.json"), 0, "bend: 6 frames");
}

TEST_F(ClipProgram, RomSaysItOfTheClipsItIsMadeFrom) {
  const std::string rom =
      "rom " + files_.character + " --limits " + at("limits.json") + " --frames 20 --out " + at("r.glb");
  expect(rom + " --from " + at("twisted.glb"), 0, "twisted.glb: 'lower' is turned by 45 degrees");
  EXPECT_EQ(run_verb(rom + " --from " + files_.motion).output.find("beyond its limits"), std::string::npos);
  expect(rom + " --from " + at("renamed.glb"), 3, "moves no joint");
  expect(rom + " --from " + at("renamed.glb") + " --joint-map " + at("map.json"), 0, "wrote");
}

// The dataset remembers the map, so that whoever reads the motion again reads the same.
TEST_F(ClipProgram, ATakeRemembersItsJointMap) {
  const Clip clip = read_clip(files_.motion, limb_.skeleton, {});
  Pc2Writer writer(folder_ / "all.pc2", limb_.output_count(), 6);
  for (const Pose& pose : clip.poses) writer.append(output_from_welded(limb_, skin_linear(limb_, pose)));
  writer.close();
  const std::string add = "dataset add " + at("data") + " --clip " + at("renamed.glb") + " --shapes " + at("all.pc2");
  const std::string character = " --character " + files_.character, map = " --joint-map " + at("map.json");
  expect(add + character, 3, "moves no joint");
  expect(add + character + map, 0, "");
  const Dataset dataset = read_dataset(folder_ / "data/dataset.json");
  EXPECT_EQ(dataset.takes[0].joint_map, "../map.json");
  const Clip again = read_clip(dataset, dataset.takes[0], limb_.skeleton);
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_NEAR(again.poses[k].joints[1].rotation[2], clip.poses[k].joints[1].rotation[2], 1e-6);
  }
  expect("check " + at("data"), 0, "it belongs together");
  bool hashed = false;
  for (const HashedFile& file : hashed_files(dataset)) hashed = hashed || file.path == "../map.json";
  EXPECT_TRUE(hashed);

  std::filesystem::copy_file(folder_ / "map.json", folder_ / "other.json");
  expect(add + " --replace --joint-map " + at("other.json"), 3, "joint map '../map.json'");
  put_map(R"([{"from": "bone_x", "to": "lower"}])");
  expect("check " + at("data"), 3, "'bone_x'");
  std::filesystem::remove(folder_ / "map.json");
  expect("check " + at("data"), 4, "map.json");
}

TEST_F(ClipProgram, MapsOfOtherJointsAreRefused) {
  const std::string check = "check " + files_.character + " --clip " + at("renamed.glb") + " --joint-map ";
  put_map(R"([{"from": "bone_c", "to": "upper"}])");
  expect(check + at("map.json"), 3, "maps the joint 'bone_c', which the clip");
  put_map(R"([{"from": "bone_a", "to": "uper"}])");
  expect(check + at("map.json"), 3, "'uper', which the character does not have: 'upper'");
  put_map("[]");
  expect(check + at("map.json"), 4, "maps no joint");
  expect(check + "''", 64, "--joint-map");
  expect(check + at("none.json"), 4, "none.json");
}

TEST_F(ClipProgram, WhatABvhDoesNotSayCanBeSaid) {
  Clip clip = read_clip(files_.motion, limb_.skeleton, {});
  for (Pose& pose : clip.poses) pose.joints[0].translation = {0, 3, 0};
  write_bvh(clip, limb_.skeleton, folder_ / "bend.bvh");
  const auto place = [&](double unit, const std::string& up) {
    cli::ClipArguments arguments;
    arguments.source = at("bend.bvh");
    arguments.options.unit = unit;
    arguments.options.up = up;
    std::vector<int> frames;
    return arguments.read(limb_.skeleton, 0.01, frames).poses[0].joints[0].translation;
  };
  EXPECT_NEAR(length(place(0, "") - Vec3{0, 3, 0}), 0, 1e-5);  // in metres, as its bones tell
  EXPECT_NEAR(length(place(0.5, "") - Vec3{0, 1.5, 0}), 0, 1e-5);
  EXPECT_NEAR(length(place(0, "z") - Vec3{0, 0, -3}), 0, 1e-5);

  const std::string check = "check " + files_.character + " --clip ";
  expect(check + at("bend.bvh") + " --up -z", 0, "its axis -z is up");
  expect(check + at("bend.bvh") + " --up up", 64, "not 'up'");
  expect(check + files_.motion + " --up z", 64, "only a BVH file does not say what is up");

  ASSERT_EQ(run_verb("train --ddm-only " + files_.character + " --out " + at("limb.safetensors")).exit_code, 0);
  const std::string limb = files_.character, basis = at("limb.safetensors"), clip_file = at("bend.bvh");
  for (const std::string& command : {"rom " + limb + " --from " + clip_file + " --out " + at("rom.glb"),
                                     "rig " + limb + " --clip " + clip_file + " --out " + at("rig"),
                                     "transfer basis " + basis + " " + limb + " --out " + at("b.safetensors") +
                                         " --report " + at("r.html") + " --clip " + clip_file,
                                     "eval " + basis + " --clip " + clip_file + " --device cpu --out " + at("o.pc2")}) {
    expect(command + " --up up", 64, "an axis that is up is x, y, z, -x, -y or -z, not 'up'");
  }
}

TEST_F(ClipProgram, EvalWritesThePosedJointsBesideTheSkin) {
  expect("train --ddm-only " + files_.character + " --out " + at("limb.safetensors"), 0, "");
  const std::string eval =
      "eval " + at("limb.safetensors") + " --device cpu --clip " + files_.motion + " --frames 2-5x3 ";
  expect(eval + "--out " + at("a.pc2") + " --rig " + at("rig.glb"), 0, "rig.glb");
  const Clip meant = read_clip(files_.motion, limb_.skeleton, {}), rig = read_clip(at("rig.glb"), limb_.skeleton, {});
  ASSERT_EQ(rig.poses.size(), 4u);  // those between are in it, too
  EXPECT_NEAR(angle_between(rig.poses[3].joints[1].rotation, meant.poses[4].joints[1].rotation), 0, 1e-6);
  expect(eval + "--out " + at("a.mdd") + " --unit-out 0.5 --rig " + at("twice.glb"), 0, "");
  const Clip twice = read_clip(at("twice.glb"), limb_.skeleton, {.unit = 0.5});
  EXPECT_NEAR(length(twice.poses[0].joints[1].translation - rig.poses[0].joints[1].translation), 0, 1e-6);
  EXPECT_NEAR(Pc2Reader(at("a.mdd")).sample(1)[0], 2 * Pc2Reader(at("a.pc2")).sample(1)[0], 1e-6);
  expect(eval + "--out " + at("a.usda") + " --rig " + at("rig.usda"), 0, "rig.usda");
  expect(eval + "--out " + at("skin.glb") + " --character " + files_.character, 0, "no texture coordinates");
  expect(eval + "--out " + at("a.pc2") + " --character " + files_.character, 64, "point caches hold points alone");
  expect(eval + "--out " + at("a.pc2") + " --rig " + at("rig.fbx"), 64, "does not end in .glb, .usda or .bvh");
  expect(eval + "--out " + at("a.mdd") + " --unit-out 0.5 --rig " + at("twice.bvh"), 64, "is in metres with Y up");
  expect(eval + "--out " + at("a.pc2") + " --axis z --rig " + at("turned.usda"), 64, "is in metres with Y up");

  // It takes the place of no other file, by whatever name, be it there or not.
  std::filesystem::create_hard_link(files_.motion, at("link.glb"));
  for (const std::string& taken : {files_.motion, at("./link.glb")}) {
    expect(eval + "--out " + at("a.pc2") + " --rig " + taken, 64, "would write over " + files_.motion);
  }
  EXPECT_EQ(read_clip(files_.motion, limb_.skeleton, {}).poses.size(), meant.poses.size());
  expect(eval + "--out " + at("new.glb") + " --rig " + at("./new.glb"), 64, "would write over " + at("new.glb"));
  EXPECT_FALSE(std::filesystem::exists(at("new.glb")));

  // Without the rig that is asked for the shot is not done.
  const std::string task = eval + "--resume --out " + at("task.pc2");
  expect(task, 0, "");
  expect(task + " --pretend --rig " + at("later.glb"), 0, "would evaluate");
  expect("join " + at("a.mdd") + " --out " + at("b.mdd"), 64, "parts of MDD cannot be joined");
}

TEST_F(ClipProgram, EvalWritesARigOfTheCharacterAndItsShapes) {
  expect("train --ddm-only " + files_.character + " --out " + at("limb.safetensors"), 0, "");
  const std::string eval =
      "eval " + at("limb.safetensors") + " --device cpu --clip " + files_.motion + " --frames 2-5 --rigged ";
  expect(eval + "--out " + at("rig.glb") + " --character " + files_.character, 0, "wrote " + at("rig.glb"));
  const Character written = read_character(at("rig.glb"));
  EXPECT_EQ(written.output_count(), limb_.output_count());
  EXPECT_NEAR((written.vertices - limb_.vertices).cwiseAbs().maxCoeff(), 0, 1e-6);
  const Clip meant = read_clip(files_.motion, limb_.skeleton, {}), rig = read_clip(at("rig.glb"), limb_.skeleton, {});
  ASSERT_EQ(rig.poses.size(), 4u);
  EXPECT_NEAR(angle_between(rig.poses[3].joints[1].rotation, meant.poses[4].joints[1].rotation), 0, 1e-6);
  expect(eval + "--out " + at("rig.usda") + " --character " + files_.character, 0, "wrote " + at("rig.usda"));
  expect(eval + "--out " + at("no.glb"), 64, "--rigged needs the character's own file");
  expect(eval + "--out " + at("no.pc2"), 64, "--rigged is for .glb and .usda");
  EXPECT_FALSE(std::filesystem::exists(at("no.glb")));
}

}  // namespace clip_program_test
}  // namespace bodyopt
