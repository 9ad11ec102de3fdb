// eval and join as a farm runs them: done once, taken up where they were interrupted, written as USD, joined.
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>

#include "assets/caches/pc2.h"
#include "assets/caches/usda_part.h"
#include "assets/clips/clip.h"
#include "runtime/core/error.h"
#include "runtime/core/json.h"
#include "runtime/deformer/deformer.h"
#include "tests/support/background_program.h"
#include "tests/support/page_contents.h"
#include "tests/support/read_bytes.h"
#include "tests/support/run_program.h"
#include "tests/support/run_verb.h"
#include "tests/support/small_basis.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace {

class EvalTask : public ::testing::Test {
 protected:
  void SetUp() override {
    const Basis basis = bodyopt::testing::small_basis();
    save_basis(basis, path("hero.safetensors"));
    write_motion(2000, 1);
  }
  void write_motion(int frames, double speed) const {
    const Skeleton skeleton = bodyopt::testing::small_basis().skeleton;
    Clip clip;
    for (int f = 0; f < frames; ++f) {
      Pose pose = bind_pose(skeleton);
      pose.joints[0].translation[0] += 0.001 * speed * f;
      pose.joints[1].rotation = axis_angle({0, 0, 1}, 0.3 * std::sin(0.1 * speed * f));
      clip.poses.push_back(pose);
    }
    write_clip(clip, skeleton, path("walk.glb"));
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string command(const std::string& options, const std::string& out) const {
    return "eval " + path("hero.safetensors") + " --clip " + path("walk.glb") + " --device cpu --out '" + path(out) +
           "' " + options;
  }
  ProgramResult eval(const std::string& options, const std::string& out) const {
    return run_verb(command(options, out));
  }

  TemporaryFolder folder_;
};

TEST_F(EvalTask, AListIsMadeAsEachOfItWouldBe) {
  const auto write_list =
      [&](const std::string& frames) {
        std::ofstream(path("crowd.json"))
            << R"({"schema": "bodyopt-shots-1", "show": "crowd", "defaults": {"shot": "s", "basis": "hero.safetensors",
              "clip": "walk.glb", "device": "cpu", "out": "{element}.pc2"}, "elements": [
              {"element": "a", "frames": "1-9"}, {"element": "b", "frames": ")"
            << frames << R"("}]})";
      };
  const auto run = [&](const std::string& more) { return run_verb("eval --list " + path("crowd.json") + more); };
  write_list("5-2001");
  EXPECT_EQ(run("").exit_code, 64);
  EXPECT_FALSE(std::filesystem::exists(path("a.pc2")));
  write_list("5-7");
  const ProgramResult made = run("");
  ASSERT_EQ(made.exit_code, 0) << made.output;
  ASSERT_EQ(eval("--frames 5-7", "alone.pc2").exit_code, 0);
  EXPECT_EQ(testing::read_bytes(path("b.pc2")), testing::read_bytes(path("alone.pc2")));
  std::filesystem::remove(path("b.pc2"));
  const ProgramResult again = run("");
  ASSERT_EQ(again.exit_code, 0) << again.output;
  EXPECT_NE(again.output.find("already done: " + path("a.pc2")), std::string::npos) << again.output;
  EXPECT_EQ(testing::read_bytes(path("b.pc2")), testing::read_bytes(path("alone.pc2")));
  for (const char* more : {" --out c.pc2", " hero.safetensors", " --jiggle"}) EXPECT_EQ(run(more).exit_code, 64);
}

TEST_F(EvalTask, ACheckRunsTheCpuBesideTheDevice) {
  if (!has_vulkan_device()) GTEST_SKIP() << "no Vulkan device";
  const auto on_device = [&](const std::string& options, const std::string& out) {
    return run_verb("eval " + path("hero.safetensors") + " --clip " + path("walk.glb") +
                    " --frames 1-5 --require-device --out " + path(out) + options);
  };
  ASSERT_EQ(on_device("", "a.pc2").exit_code, 0);
  const ProgramResult checked = on_device(" --check", "b.pc2");
  ASSERT_EQ(checked.exit_code, 0) << checked.output;
  EXPECT_EQ(testing::read_bytes(path("a.pc2")), testing::read_bytes(path("b.pc2")));
  const ProgramResult nothing_to_compare = eval("--frames 1-5 --check", "c.pc2");
  EXPECT_EQ(nothing_to_compare.exit_code, 5);
  EXPECT_NE(nothing_to_compare.output.find("name a device"), std::string::npos) << nothing_to_compare.output;
  EXPECT_FALSE(std::filesystem::exists(path("c.pc2")));
}

TEST_F(EvalTask, WhatIsDoneIsSkippedAndWhatIsStaleIsDoneAgain) {
  ASSERT_EQ(eval("--frames 1-20 --resume", "a.pc2").exit_code, 0);
  const std::string first = testing::read_bytes(path("a.pc2"));
  EXPECT_NE(eval("--frames 1-20 --resume", "a.pc2").output.find("already done"), std::string::npos);
  EXPECT_EQ(eval("--frames 1-21 --resume", "a.pc2").output.find("already done"), std::string::npos);
  EXPECT_EQ(Pc2Reader(path("a.pc2")).sample_count(), 21u);
  EXPECT_EQ(eval("--frames 1-20 --resume", "a.pc2").output.find("already done"), std::string::npos);
  std::ofstream(path("a.pc2"), std::ios::in | std::ios::binary).seekp(100) << "rot!";
  EXPECT_EQ(eval("--frames 1-20 --resume", "a.pc2").output.find("already done"), std::string::npos);
  EXPECT_EQ(testing::read_bytes(path("a.pc2")), first);
  write_motion(2000, 2);
  EXPECT_NE(eval("--frames 1-20 --resume --pretend", "a.pc2").output.find("would evaluate"), std::string::npos);
  EXPECT_EQ(testing::read_bytes(path("a.pc2")), first);
  EXPECT_EQ(eval("--frames 1-20 --resume", "a.pc2").exit_code, 0);
  EXPECT_NE(testing::read_bytes(path("a.pc2")), first);
}

TEST_F(EvalTask, AnInterruptedRunGoesOnToTheSameBytes) {
  for (const std::string out : {"whole.pc2", "whole.usda"}) ASSERT_EQ(eval("", out).exit_code, 0);
  for (const std::string ending : {".pc2", ".usda"}) {
    BackgroundProgram program(kProgram + " " + command("--resume", "parts" + ending), path("log"));
    comes_true([&] { return !program.runs(); }, 0.12);
    program.send(SIGTERM);
    const std::optional<int> code = program.wait(60);
    ASSERT_TRUE(code.has_value());
    if (*code == 75) {
      EXPECT_FALSE(std::filesystem::exists(path("parts" + ending)));
      EXPECT_TRUE(std::filesystem::exists(path("parts" + ending + ".checkpoint"))) << program.output();
    }
    ASSERT_EQ(eval("--resume", "parts" + ending).exit_code, 0);
    EXPECT_EQ(testing::read_bytes(path("parts" + ending)), testing::read_bytes(path("whole" + ending)));
    EXPECT_FALSE(std::filesystem::exists(path("parts" + ending + ".checkpoint")));
  }
}

TEST_F(EvalTask, JoinedPartsAreTheWhole) {
  for (const std::string ending : {".pc2", ".usda"}) {
    ASSERT_EQ(eval("--frames 1-50", "whole" + ending).exit_code, 0);
    ASSERT_EQ(eval("--frames 1-20", "part.##" + ending).exit_code, 0);
    ASSERT_EQ(eval("--frames 21-21", "part.##" + ending).exit_code, 0);
    ASSERT_EQ(eval("--frames 22-50", "part.##" + ending).exit_code, 0);
    const auto join = [&](const std::string& parts) {
      std::string names;
      for (const char part : parts)
        names += " " + path(std::string("part.") + (part == 'a' ? "01" : part == 'b' ? "21" : "22") + ending);
      return run_verb("join" + names + " --out " + path("joined" + ending));
    };
    ASSERT_EQ(join("cab").exit_code, 0);
    EXPECT_EQ(testing::read_bytes(path("joined" + ending)), testing::read_bytes(path("whole" + ending)));
    const ProgramResult twice = join("abb");
    EXPECT_EQ(twice.exit_code, 3) << twice.output;
    EXPECT_NE(twice.output.find("no frames in common"), std::string::npos) << twice.output;
  }
  std::ofstream(path("part.01.usda"), std::ios::app) << "}\n";
  std::filesystem::resize_file(path("part.22.usda"), std::filesystem::file_size(path("part.22.usda")) - 3000);
  EXPECT_EQ(run_verb("join " + path("part.22.usda") + " --out " + path("joined.usda")).exit_code, 4);
}

TEST_F(EvalTask, UsdHoldsTheNumbersOfPc2) {
  ASSERT_EQ(eval("--frames 5-7", "a.pc2").exit_code, 0);
  ASSERT_EQ(eval("--frames 5-7", "a.usda").exit_code, 0);
  std::ifstream file(path("a.usda"));
  std::uint32_t sample = 0;
  bool are_points = false;
  std::size_t normals = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.find("timeSamples") != std::string::npos) are_points = line.find("points") != std::string::npos;
    if (!line.starts_with("        ")) continue;
    EXPECT_EQ(std::stoi(line), 5 + static_cast<int>(sample % 3));
    std::vector<float> values;
    for (std::size_t at = line.find('['); (at = line.find_first_of("(,", at + 1)) != std::string::npos;) {
      if (at + 1 < line.size() && line[at] == ',' && line[at - 1] == ')') continue;
      if (at + 1 < line.size() && line.substr(at + 1).find_first_of("0123456789") < 3)
        values.push_back(std::stof(line.substr(at + 1)));
    }
    if (are_points) {
      EXPECT_EQ(values, Pc2Reader(path("a.pc2")).sample(sample));
    } else {
      ++normals;
      for (std::size_t k = 0; k + 2 < values.size(); k += 3) {
        const float length = std::hypot(values[k], values[k + 1], values[k + 2]);
        EXPECT_TRUE(std::abs(length - 1) < 1e-4f || length == 0) << length;
      }
    }
    ++sample;
  }
  EXPECT_EQ(sample, 6u);
  EXPECT_EQ(normals, 3u);
  EXPECT_EQ(UsdaPart(path("a.usda")).points(2), Pc2Reader(path("a.pc2")).sample(2));
  EXPECT_THROW(UsdaPart(path("a.usda")).points(3), Error);
}

TEST_F(EvalTask, ProgressIsAsProgramsReadIt) {
  const ProgramResult json = eval("--frames 1-20 --progress json", "a.pc2");
  const std::size_t begin = json.output.find("{\"progress\"");
  ASSERT_NE(begin, std::string::npos) << json.output;
  const auto line = Json::parse(json.output.substr(begin, json.output.find('\n', begin) - begin));
  EXPECT_EQ(line.at("total"), 20);
  EXPECT_NE(eval("--frames 1-20 --progress openjd", "a.pc2").output.find("openjd_progress: 100.0\n"),
            std::string::npos);
}

// The whole way on this machine: plan, run, status.
TEST_F(EvalTask, APlannedShowIsDoneWholeAndOnlyOnce) {
  std::ofstream(path("shots.json")) << R"({"schema": "bodyopt-shots-1", "defaults": {"basis": "hero.safetensors",
    "clip": "walk.glb", "device": "cpu", "out": "out/{shot}/{element}.pc2"}, "elements": [
    {"shot": "a $(touch hit) 'b' \"c\"\nd;", "element": "hero", "frames": "1-40"},
    {"shot": "long", "element": "hero", "frames": "1-120", "frame_ms": 1000}]})";
  const std::string plan = path("plan");
  const ProgramResult planned = run_verb("farm plan " + path("shots.json") + " --task-minutes 1 --out " + plan);
  ASSERT_EQ(planned.exit_code, 0) << planned.output;
  const ProgramResult ran = run_verb("farm run " + plan);
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  const auto told = Json::parse(run_program(kProgram + " farm status " + plan + " --json - 2>/dev/null").output);
  EXPECT_EQ(told.at("elements"), (Json{{"done", 2}}));
  ASSERT_EQ(eval("--frames 1-120", "whole.pc2").exit_code, 0);
  EXPECT_EQ(testing::read_bytes(folder_ / "out" / "long" / "hero.pc2"), testing::read_bytes(path("whole.pc2")));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out" / "a $(touch hit) 'b' \"c\"\nd;" / "hero.pc2"));
  EXPECT_EQ(run_verb("farm run " + plan).output.find("wrote"), std::string::npos);
  std::filesystem::remove(folder_ / "out" / "long" / "hero.pc2");
  const auto again = Json::parse(run_program(kProgram + " farm status " + plan + " --json - 2>/dev/null").output);
  EXPECT_EQ(again.at("elements"), (Json{{"done", 1}, {"missing", 1}}));
}

TEST_F(EvalTask, AJobTakesThePlaceOfNoOtherFile) {
  std::ofstream(path("shots.json")) << R"({"schema": "bodyopt-shots-1", "elements": [{"shot": "a", "element": "b",
    "basis": "hero.safetensors", "clip": "walk.glb", "out": "a.pc2"}]})";
  ASSERT_EQ(run_verb("farm plan " + path("shots.json") + " --out " + path("plan")).exit_code, 0);
  std::ofstream(path("arm.xml")) << "<mujoco/>";
  const auto expect_refused = [&](int exit_code, const std::string& option, const std::string& file) {
    const std::string before = testing::read_bytes(path(file));
    const ProgramResult refused = run_verb("farm submit " + path("plan") + " " + option + " " + path(file));
    EXPECT_EQ(refused.exit_code, exit_code) << refused.output;
    EXPECT_NE(refused.output.find(path(file)), std::string::npos) << refused.output;
    EXPECT_EQ(testing::read_bytes(path(file)), before);
  };
  expect_refused(64, "--openjd", "plan/plan.json");
  expect_refused(4, "--openjd", "shots.json");
  expect_refused(4, "--opencue", "arm.xml");
  for (int k = 0; k < 2; ++k) {
    EXPECT_EQ(run_verb("farm submit " + path("plan") + " --openjd " + path("job.json")).exit_code, 0);
  }
}

// The page of a show, and its frames as `simulate` takes them; names in it are text.
TEST_F(EvalTask, AReportIsOnePageWithPicturesOfTheCaches) {
  std::ofstream(path("shots.json")) << R"({"schema": "bodyopt-shots-1", "defaults": {"basis": "hero.safetensors",
    "clip": "walk.glb", "device": "cpu", "out": "out/{shot}.pc2"}, "elements": [
    {"shot": "a<b>$(touch hit) c", "element": "hero", "frames": "1-40"},
    {"shot": "usd", "element": "hero", "frames": "900-940", "out": "out/{shot}.usda"},
    {"shot": "open", "element": "hero", "frames": "1-2"}]
})";
  const std::string plan = path("plan");
  ASSERT_EQ(run_verb("farm plan " + path("shots.json") + " --out " + plan).exit_code, 0);
  ASSERT_EQ(run_verb("farm run " + plan).exit_code, 0);
  std::filesystem::remove(folder_ / "out" / "open.pc2");
  const ProgramResult ran =
      run_verb("farm report " + plan + " --out " + path("show.html") + " --json " + path("r.json"));
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  const auto told = Json::parse(testing::read_bytes(path("r.json")));
  EXPECT_EQ(told.at("elements").at(2).at("state"), "missing");
  ASSERT_EQ(told.at("worth_a_look").size(), 6u);
  const std::string page = testing::read_bytes(path("show.html"));
  const auto contents = Json::parse(testing::page_json(page));
  EXPECT_EQ(contents.at("figures"), told);
  EXPECT_EQ(told.at("elements").at(0).at("shot"), "a<b>$(touch hit) c");
  EXPECT_EQ(page.find("<b>$"), std::string::npos);
  EXPECT_EQ(page.find("src=\"http"), std::string::npos);
  const auto& looks = contents.at("pictures").at("looks");
  ASSERT_EQ(looks.size(), 6u);
  for (const auto& look : looks) EXPECT_TRUE(look.at("src").get<std::string>().starts_with("data:image/png;base64,"));
  EXPECT_EQ(run_verb("farm report " + plan + " --out " + path("show.pdf")).exit_code, 64);
}

}  // namespace
}  // namespace bodyopt
