// eval --jiggle: chunks of a shot, pre-roll, cuts, what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "assets/caches/pc2.h"
#include "assets/clips/clip.h"
#include "runtime/core/json.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/run_verb.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace {

// A limb, its basis and dynamics, and a clip of 30 frames: it rests, swings, and stops dead after frame 16.
class Jiggle : public ::testing::Test {
 protected:
  void SetUp() override {
    const Character limb = limb_character();
    write_character(limb, path("limb.glb"));
    Clip clip;
    clip.name = "swing";
    for (int f = 0; f < 30; ++f) {
      const double t = std::clamp((f - 3) / 24.0, 0.0, 0.5);
      Pose pose = bind_pose(limb.skeleton);
      pose.joints[0].translation[0] += 0.4 * t;
      pose.joints[1].rotation = axis_angle({1, 0, 0}, 4 * t * t);
      clip.poses.push_back(pose);
    }
    write_clip(clip, limb.skeleton, path("swing.glb"));
    ASSERT_EQ(run("train --ddm-only " + path("limb.glb") + " --out " + path("limb.safetensors")).exit_code, 0);
    ASSERT_EQ(run("dynamics " + path("limb.glb") + " --basis " + path("limb.safetensors") + " --out " +
                  path("limb.dynamics.safetensors") + " --dynamics-resolution 2500")
                  .exit_code,
              0);
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  static ProgramResult run(const std::string& arguments) { return run_verb(arguments); }
  ProgramResult eval(const std::string& options, const std::string& out) const {
    return run("eval " + path("limb.safetensors") + " --clip " + path("swing.glb") + " --device cpu --out " +
               path(out) + " " + options);
  }
  std::vector<float> frame(const std::string& cache, std::uint32_t sample) const {
    return Pc2Reader(path(cache)).sample(sample);
  }
  void expect_refused(int exit_code, const std::string& options, const std::string& named) const {
    const ProgramResult result = eval(options, "refused.pc2");
    EXPECT_EQ(result.exit_code, exit_code) << options << "\n" << result.output;
    EXPECT_NE(result.output.find(named), std::string::npos) << options << "\n" << result.output;
    EXPECT_FALSE(std::filesystem::exists(path("refused.pc2"))) << options;
  }

  TemporaryFolder folder_;
};

TEST_F(Jiggle, ChunksOfAShotGiveTheSameBits) {
  ASSERT_EQ(eval("--jiggle --state-out " + path("end.state") + " --state-every 10", "whole.pc2").exit_code, 0);
  for (const char* state : {"end.state", "end.10.state", "end.20.state", "end.30.state"}) {
    EXPECT_TRUE(std::filesystem::exists(path(state))) << state;
  }
  ASSERT_EQ(eval("--jiggle --frames 21-30 --state-in " + path("end.20.state"), "third.pc2").exit_code, 0);
  ASSERT_EQ(eval("--jiggle --frames 1-13 --state-out " + path("own.state"), "first.pc2").exit_code, 0);
  ASSERT_EQ(eval("--jiggle --frames 14-20 --state-in " + path("own.state"), "second.pc2").exit_code, 0);
  for (std::uint32_t f = 0; f < 30; ++f) {
    const std::vector<float> whole = frame("whole.pc2", f);
    EXPECT_EQ(whole, f < 13   ? frame("first.pc2", f)
                     : f < 20 ? frame("second.pc2", f - 13)
                              : frame("third.pc2", f - 20))
        << f + 1;
  }
  ASSERT_EQ(eval("", "still.pc2").exit_code, 0);
  EXPECT_EQ(frame("still.pc2", 2), frame("whole.pc2", 2));  // nothing has moved
  EXPECT_NE(frame("still.pc2", 17), frame("whole.pc2", 17));
}

// What an animator saw jiggle does not come out still without a word.
TEST_F(Jiggle, ASessionThatJigglesIsToldWithoutIt) {
  const auto warns = [&](const std::string& on, const std::string& options) {
    std::ofstream(path("shot.json")) << R"({"schema": "bodyopt-session-1", "view": {"jiggle": {"on": )" << on
                                     << R"(}}, "characters": [{"basis": "limb.safetensors", "clip": "swing.glb"}]})";
    const ProgramResult result =
        run("eval --session " + path("shot.json") + " --device cpu --out " + path("s.pc2") + options);
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return result.output.find("shot.json: its lead jiggles in the viewport, and is evaluated without: give --jiggle") !=
           std::string::npos;
  };
  EXPECT_TRUE(warns("true", ""));
  ASSERT_EQ(eval("", "still.pc2").exit_code, 0);
  EXPECT_EQ(frame("s.pc2", 17), frame("still.pc2", 17));
  EXPECT_FALSE(warns("true", " --jiggle"));
  EXPECT_FALSE(warns("false", ""));
  std::filesystem::remove(path("limb.dynamics.safetensors"));
  EXPECT_FALSE(warns("true", ""));
}

TEST_F(Jiggle, PrerollStepsFramesThatAreNotWritten) {
  ASSERT_EQ(eval("--jiggle", "whole.pc2").exit_code, 0);
  ASSERT_EQ(eval("--jiggle --frames 18-20 --preroll 17", "rolled.pc2").exit_code, 0);
  EXPECT_EQ(Pc2Reader(path("rolled.pc2")).sample_count(), 3u);
  EXPECT_EQ(frame("rolled.pc2", 0), frame("whole.pc2", 17));
  const ProgramResult shorter = eval("--jiggle --frames 18-20 --preroll 40", "short.pc2");
  EXPECT_EQ(shorter.exit_code, 0);
  EXPECT_NE(shorter.output.find("pre-roll is that short"), std::string::npos) << shorter.output;
}

TEST_F(Jiggle, ACutStartsAnewAndIsSaid) {
  const ProgramResult result = eval("--jiggle --cuts 18 --json " + path("eval.json"), "cut.pc2");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("frame 18: a cut, as declared"), std::string::npos) << result.output;
  ASSERT_EQ(eval("", "still.pc2").exit_code, 0);
  EXPECT_EQ(frame("cut.pc2", 17), frame("still.pc2", 17));
  std::ifstream file(path("eval.json"));
  const auto json = Json::parse(file);
  EXPECT_EQ(json.at("notes").size(), 1u);
  EXPECT_GT(json.at("milliseconds_per_frame").at("jiggle").get<double>(), 0);
  for (std::uint32_t f = 0; f < 30; ++f) {
    const std::vector<float> moved = frame("cut.pc2", f), still = frame("still.pc2", f);
    double largest = 0;
    for (std::size_t k = 0; k < moved.size(); k += 3) {
      largest = std::max(largest, std::hypot(static_cast<double>(moved[k] - still[k]),
                                             static_cast<double>(moved[k + 1] - still[k + 1]),
                                             static_cast<double>(moved[k + 2] - still[k + 2])));
    }
    const auto& told = json.at("per_frame")[f];
    EXPECT_NEAR(told.at("jiggle_max_mm").get<double>(), 1e3 * largest, 1e-3) << f;
    EXPECT_LE(told.at("jiggle_rms_mm").get<double>(), told.at("jiggle_max_mm").get<double>());
    EXPECT_EQ(told.at("inverted_tets"), 0) << f;
  }
  EXPECT_NE(result.output.find("the jiggle moves the skin by"), std::string::npos) << result.output;
}

TEST_F(Jiggle, InfoReadsAState) {
  ASSERT_EQ(eval("--jiggle --frames 1-12 --state-out " + path("at12.state"), "first.pc2").exit_code, 0);
  const ProgramResult told = run("info " + path("at12.state") + " --json -");
  ASSERT_EQ(told.exit_code, 0) << told.output;
  const auto json = Json::parse(told.output);
  EXPECT_EQ(json.at("kind"), "state of the jiggle");
  EXPECT_EQ(json.at("frame"), 12);
  EXPECT_EQ(json.at("known"), 2);
  const auto dynamics = Json::parse(run("info " + path("limb.dynamics.safetensors") + " --json -").output);
  EXPECT_EQ(json.at("nodes"), dynamics.at("nodes"));
  EXPECT_EQ(json.at("dynamics"), dynamics.at("metadata").at("checksum"));
  std::filesystem::copy_file(path("swing.glb"), path("wrong.state"));
  EXPECT_EQ(run("info " + path("wrong.state")).exit_code, 4);
}

TEST_F(Jiggle, AnEmptyClipIsNamedForWhatItIs) {
  const ProgramResult result = run("eval " + path("limb.safetensors") + " --clip '' --out " + path("none.pc2"));
  EXPECT_EQ(result.exit_code, 64);
  EXPECT_NE(result.output.find("--clip: expected a value, found an empty one"), std::string::npos) << result.output;
}

TEST_F(Jiggle, RefusesWhatDoesNotGoTogether) {
  expect_refused(64, "--preroll 3", "--jiggle");
  expect_refused(64, "--jiggle --preroll 0", "not in range 1 to 1000000");
  expect_refused(64, "--jiggle --fps nan", "expected a number from 0.001 to 100000, found 'nan'");
  expect_refused(64, "--jiggle --state-every 3", "--state-out");
  expect_refused(64, "--jiggle --preroll 2 --state-in x.state", "--preroll");
  expect_refused(64, "--jiggle --gravity-change 1 nan 0", "finite");
  expect_refused(64, "--jiggle --gravity-change 0 -1e30 0", "1000 m/s^2");
  expect_refused(3, "--jiggle --fps 30", "24");
  expect_refused(4, "--jiggle --dynamics " + path("none.safetensors"), "none.safetensors");
  expect_refused(4, "--jiggle --dynamics " + path("limb.safetensors"), "limb.safetensors");
  expect_refused(4, "--jiggle --state-in " + path("limb.safetensors"), "not a state of the jiggle");
  ASSERT_EQ(eval("--jiggle --frames 1-12 --state-out " + path("at12.state"), "first.pc2").exit_code, 0);
  expect_refused(64, "--jiggle --frames 5-9 --state-in " + path("at12.state"), "after frame 12");
  std::filesystem::remove(path("limb.dynamics.safetensors"));
  expect_refused(4, "--jiggle", "bodyopt dynamics");
}

// In centimetres and Z up a point (x, y, z) of metres is (100 x, -100 z, 100 y).
TEST_F(Jiggle, CachesAreInTheUnitAndAxisAskedFor) {
  ASSERT_EQ(eval("--frames 12", "metres.pc2").exit_code, 0);
  ASSERT_EQ(eval("--frames 12 --unit-out 0.01 --axis z", "centimetres.pc2").exit_code, 0);
  const std::vector<float> metres = frame("metres.pc2", 0), centimetres = frame("centimetres.pc2", 0);
  ASSERT_EQ(metres.size(), centimetres.size());
  for (std::size_t k = 0; k + 2 < metres.size(); k += 3) {
    EXPECT_NEAR(centimetres[k], 100 * metres[k], 1e-4);
    EXPECT_NEAR(centimetres[k + 1], -100 * metres[k + 2], 1e-4);
    EXPECT_NEAR(centimetres[k + 2], 100 * metres[k + 1], 1e-4);
  }
  EXPECT_EQ(eval("--axis x", "other.pc2").exit_code, 64);
  EXPECT_EQ(eval("--unit-out 0", "other.pc2").exit_code, 64);
}

// Of a file in another unit a cache in metres does not lie on its mesh.
TEST_F(Jiggle, ACacheInMetresOfAFileThatIsNotSaysWhichUnitLiesOnIt) {
  const std::string half = path("half.safetensors"), said = "--unit-out 0.5 lays it on the mesh";
  ASSERT_EQ(run("train --ddm-only " + path("limb.glb") + " --unit 0.5 --out " + half).exit_code, 0);
  const auto says = [&](const std::string& basis, const std::string& options) {
    const ProgramResult result = run("eval " + basis + " --clip " + path("swing.glb") +
                                     " --frames 12 --device cpu --out " + path("cache.pc2") + options);
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return result.output.find("--unit-out") != std::string::npos ? result.output : "";
  };
  EXPECT_NE(says(half, "").find(said), std::string::npos);
  EXPECT_EQ(says(half, " --unit-out 0.5"), "");
  EXPECT_EQ(says(path("limb.safetensors"), ""), "");
}

// What a safetensors file holds behind its header, which here tells of other settings.
std::string tensors_of(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::uint64_t header = 0;
  stream.read(reinterpret_cast<char*>(&header), sizeof header);
  stream.seekg(static_cast<std::streamoff>(header), std::ios::cur);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// What it chose, given back, makes the same tables and is what it chooses: flesh in metres for all of the body, which
// would take the place of the rule by thickness, is not written.
TEST_F(Jiggle, SettingsThatWereChosenMakeTheSameDynamics) {
  const std::string dynamics =
      "dynamics " + path("limb.glb") + " --basis " + path("limb.safetensors") + " --dynamics-resolution 600 --out ";
  const std::string open = path("open.dynamics.safetensors"), back = path("back.dynamics.safetensors");
  ASSERT_EQ(run(dynamics + open + " --jiggle-out " + path("chosen.json")).exit_code, 0);
  const ProgramResult again =
      run(dynamics + back + " --jiggle " + path("chosen.json") + " --jiggle-out " + path("same.json"));
  ASSERT_EQ(again.exit_code, 0) << again.output;
  const auto read = [&](const char* name) { return Json::parse(std::ifstream(path(name))); };
  EXPECT_FALSE(read("chosen.json").contains("flesh"));
  EXPECT_EQ(read("chosen.json"), read("same.json"));
  ASSERT_GT(tensors_of(open).size(), 10000u);
  EXPECT_TRUE(tensors_of(open) == tensors_of(back));
  EXPECT_EQ(run(dynamics + open + " --jiggle-out " + path("chosen.txt")).exit_code, 64);
}

}  // namespace
}  // namespace bodyopt
