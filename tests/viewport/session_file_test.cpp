// The session as a file: what comes back, what eval makes of it, and what is refused.
#include "shots/session/session_file.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "runtime/core/error.h"
#include "runtime/core/json.h"
#include "shots/session/posed_clip.h"
#include "tests/support/error_kind.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/limb_glb.h"
#include "tests/support/paths.h"
#include "tests/support/read_bytes.h"
#include "tests/support/run_verb.h"
#include "tests/viewport/played_viewport.h"
#include "viewport/commands/commands.h"

namespace bodyopt::testing {
namespace {

using namespace shots;
using namespace draw;
using namespace viewport;

class SessionFileTest : public PlayedTest {
 protected:
  static std::string write(const std::string& text) {
    write_bytes("session.json", text);
    return "session.json";
  }
  // Two characters, posed and keyed, away from everything that is usual.
  std::string script() const {
    return "open " + limb_.basis + "; open " + limb_.clip +
           "; lead 2; turn joint1 0 0 15; lead 1; frame 3; turn upper 20 0 0; key; frame 9; turn upper 0 35 0; "
           "control flex 0.5; key; style matcap; orbit 30 10; in 2; out 11; frame 6; select upper; panels off; save " +
           (folder_ / "shot.json").string();
  }

  JigglingCharacter limb_{folder_};
};

TEST_F(SessionFileTest, BringsEverythingBackAlsoFromAnotherFolder) {
  const std::string control = small_.made.residual.controls.front();
  std::string commands = script();
  commands.replace(commands.find("flex"), 4, control);
  Image picture;
  {
    const auto viewport = open(small(), kBarePicture + "; " + commands);
    ASSERT_TRUE(std::filesystem::exists("shot.json"));
    picture = still(*viewport);
  }
  const std::string text = read_bytes("shot.json");
  EXPECT_EQ(text.find(folder_.path().string()), std::string::npos) << text;
  const TemporaryFolder other;
  const std::filesystem::path moved = other / "moved";
  std::filesystem::create_directory(moved);
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    std::filesystem::rename(entry.path(), moved / entry.path().filename());
  }
  ViewerOptions options = small();
  options.files = {(moved / "shot.json").string()};
  const auto viewport = open(options, "hud off; panels off");
  const Controls& controls = viewport->controls();
  EXPECT_EQ(controls.joint, "upper");
  EXPECT_EQ(controls.playback.frame(), 6);
  EXPECT_EQ(controls.playback.in(), 2);
  EXPECT_EQ(controls.playback.out(), 11);
  ASSERT_EQ(controls.settings.pose.keys.size(), 2u);
  EXPECT_EQ(controls.settings.pose.keys.at(9).controls.at(control), 0.5);
  ASSERT_EQ(viewport->session().scene.cast().size(), 2u);
  EXPECT_EQ(viewport->session().scene.cast()[1]->posing().joints.at("joint1"), (Vec3{0, 0, 15}));
  EXPECT_TRUE(still(*viewport).rgba == picture.rgba);
  // Saved again it is the same; and it is opened in place of others, too.
  viewport->prompt("save " + (moved / "again.json").string());
  EXPECT_EQ(read_bytes(moved / "again.json"), text);
  ViewerOptions fresh = small();
  fresh.files = {(moved / "small.safetensors").string()};
  const auto later = open(fresh, kBarePicture + "; open " + (moved / "shot.json").string());
  EXPECT_EQ(later->session().scene.cast().size(), 2u);
  EXPECT_EQ(later->controls().playback.frame(), 6);
  EXPECT_TRUE(still(*later).rgba == picture.rgba);
}

TEST_F(SessionFileTest, EvalMakesOfItWhatWasExported) {
  const std::string commands =
      "in 2; out 10; frame 3; turn upper 20 0 0; key; frame 9; turn upper 0 35 0; key; save shot.json; "
      "export-skin seen.pc2";
  { const auto viewport = open(small(), commands); }
  const ProgramResult result = run_verb("eval --session shot.json --device cpu --out evaluated.pc2");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const Pc2Reader seen("seen.pc2"), evaluated("evaluated.pc2");
  ASSERT_EQ(seen.sample_count(), 9u);
  ASSERT_EQ(evaluated.sample_count(), 9u);
  float apart = 0, moved = 0;
  for (std::size_t k = 0; k < 9; ++k) {
    const std::vector<float> a = seen.sample(k), b = evaluated.sample(k), first = seen.sample(0);
    for (std::size_t i = 0; i < a.size(); ++i) {
      apart = std::max(apart, std::abs(a[i] - b[i]));
      moved = std::max(moved, std::abs(a[i] - first[i]));
    }
  }
  EXPECT_LT(apart, 2e-6f);
  EXPECT_GT(moved, 0.05f);
  for (const char* arguments : {"small.safetensors --session shot.json", "--session shot.json --clip bend.glb", ""}) {
    const ProgramResult refused = run_verb(std::string("eval ") + arguments + " --out no.pc2");
    EXPECT_EQ(refused.exit_code, 64) << refused.output;
  }
}

// By Direct Delta Mush, with the meshes and the clip of its own file, as the viewport shows it.
TEST_F(SessionFileTest, EvalTakesACharacterThatNobodyTrained) {
  limb_file(folder_, true);
  ViewerOptions options = small();
  options.files = {"limb.glb"};
  {
    const auto viewport = open(options, "frame 9; turn joint1 20 0 0; key; in 3; save own.json; export-skin seen.pc2");
  }
  const ProgramResult result = run_verb("eval --session own.json --device cpu --out evaluated.pc2");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("not trained"), std::string::npos) << result.output;
  for (const char* ending : {".pc2", ".eye.pc2"}) {
    const Pc2Reader seen(std::string("seen") + ending), evaluated(std::string("evaluated") + ending);
    ASSERT_EQ(seen.sample_count(), evaluated.sample_count());
    EXPECT_EQ(evaluated.start_frame(), 3);
    const std::vector<float> a = seen.sample(6), b = evaluated.sample(6);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 2e-6f) << ending;
  }
  // A farm in two parts.
  std::ofstream("shots.json") << R"({"schema": "bodyopt-shots-1", "elements": [{"shot": "a", "element": "limb",
    "session": "own.json", "device": "cpu", "frame_ms": 10000, "out": "farm.pc2"}]})";
  const ProgramResult planned = run_verb("farm plan shots.json --task-minutes 1 --out plan --json plan.json");
  ASSERT_EQ(planned.exit_code, 0) << planned.output;
  EXPECT_EQ(Json::parse(read_bytes("plan.json")).at("waves"), 2);
  const ProgramResult ran = run_verb("farm run plan");
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  for (const std::string ending : {".pc2", ".eye.pc2"}) {
    EXPECT_TRUE(read_bytes("farm" + ending) == read_bytes("evaluated" + ending)) << ending;
  }
  EXPECT_EQ(run_verb("eval --session own.json --jiggle --out no.pc2").exit_code, 64);
  write(R"({"schema": "bodyopt-session-1", "characters": [{"basis": "gone.glb", "clip": "bend.glb"}]})");
  EXPECT_EQ(run_verb("eval --session session.json --out no.pc2").exit_code, 4);
}

TEST_F(SessionFileTest, EvalKeepsARangeOfWhichOneEndIsTheClips) {
  { const auto viewport = open(small(), "out 5; save begin.json; export-skin seen.pc2"); }
  const ProgramResult result = run_verb("eval --session begin.json --device cpu --out evaluated.pc2");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const Pc2Reader seen("seen.pc2"), evaluated("evaluated.pc2");
  EXPECT_LT(seen.sample_count(), 7u);
  EXPECT_EQ(evaluated.sample_count(), seen.sample_count());
  EXPECT_EQ(evaluated.start_frame(), seen.start_frame());
}

// A script that saves a session leaves a file: it needs neither a window nor a picture.
TEST_F(SessionFileTest, IsSavedWithoutAWindow) {
  const ProgramResult saved =
      run_verb("view small.safetensors bend.glb --headless --do 'frame 3; turn upper 20 0 0; key; save kept.json'");
  ASSERT_EQ(saved.exit_code, 0) << saved.output;
  EXPECT_EQ(read_session("kept.json").cast.size(), 1u);
}

TEST_F(SessionFileTest, WhatIsDamagedIsRefusedAndLeavesWhatWasThere) {
  const std::string good = R"({"schema": "bodyopt-session-1", "characters": [{"basis": "small.safetensors"}]})";
  EXPECT_EQ(read_session(write(good)).cast.size(), 1u);
  for (const auto& [text, said] :
       {std::pair{R"({"schema": "bodyopt-session-1"})", "characters"},
        {R"({"schema": "bodyopt-session-1", "characters": []})", "characters"},
        {R"({"schema": "bodyopt-session-1", "characters": {}})", "a list"},
        {R"({"schema": "bodyopt-session-1", "characters": [7]})", "characters[0]"},
        {R"({"schema": "bodyopt-session-1", "characters": [{"basis": 3}]})", "basis"},
        {R"({"schema": "bodyopt-session-1", "characters": [{"basis": ""}]})", "basis"},
        {R"({"schema": "bodyopt-session-1", "characters": [{"clp": "a.glb"}]})", "clp"},
        {R"({"schema": "bodyopt-session-1", "characters": [{}], "frame": 1.5})", "frame"},
        {R"({"schema": "bodyopt-session-1", "characters": [{}], "fps": 0})", "fps"},
        {R"({"schema": "bodyopt-session-1", "characters": [{}], "view": {"playback": {"in": 9, "out": 2}}})", "in"},
        {R"({"schema": "bodyopt-session-1", "characters": [{"pose": {"joints": {"a": [1, 2]}}}]})", "three numbers"},
        {R"({"schema": "bodyopt-session-2", "characters": [{}]})", "bodyopt-session-1"},
        {R"({"schema": "bodyopt-session-1", "characters": [{}])", "JSON"}}) {
    try {
      read_session(write(text));
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::file);
      EXPECT_NE(std::string(error.what()).find("session.json"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(said), std::string::npos) << error.what();
    }
  }
  // None of its files is there: none of what was open goes. Of several, what is there is opened.
  write(
      R"({"schema": "bodyopt-session-1", "characters": [{"basis": "no.safetensors"}, {"basis": "nor.safetensors"}]})");
  ::testing::internal::CaptureStderr();
  const auto kept = open(small({limb_.basis}), kBarePicture + "; frame 5; open session.json");
  EXPECT_NE(::testing::internal::GetCapturedStderr().find("nor.safetensors"), std::string::npos);
  EXPECT_EQ(kept->session().scene.cast().size(), 2u);
  EXPECT_EQ(kept->controls().playback.frame(), 5);
  write(
      R"({"schema": "bodyopt-session-1", "characters": [{"basis": "small.safetensors"}, {"basis": "no.safetensors"}]})");
  ::testing::internal::CaptureStderr();
  const auto viewport = open(small({limb_.basis}), kBarePicture + "; frame 5; open session.json");
  EXPECT_NE(::testing::internal::GetCapturedStderr().find("no.safetensors"), std::string::npos);
  EXPECT_EQ(viewport->session().scene.cast().size(), 1u);
  EXPECT_EQ(kind_of([&] {
              ViewerOptions options = small();
              options.files = {"session.json"};
              options.limits = "limits.json";
              open(options);
            }),
            ErrorKind::usage);
  EXPECT_THROW(write_session({}, "/nowhere/session.json"), Error);
}

}  // namespace
}  // namespace bodyopt::testing
