// Lists of shots to plans: what is read, what is refused and how it is said, how elements are cut and packed.
#include "farm/plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>

#include "assets/clips/clip.h"
#include "base/frame_range.h"
#include "farm/queues.h"
#include "farm/task_run.h"
#include "runtime/core/error.h"
#include "tests/support/run_program.h"
#include "tests/support/small_basis.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::farm {
namespace {

class PlanShow : public ::testing::Test {
 protected:
  void SetUp() override {
    const Basis basis = bodyopt::testing::small_basis();
    save_basis(basis, folder_ / "hero.safetensors");
    Clip clip;
    clip.poses.assign(240, bind_pose(basis.skeleton));
    write_clip(clip, basis.skeleton, folder_ / "walk.glb");
  }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }
  ShowList read(const std::string& name, const std::string& text) {
    return read_show_list(write(name, text), problems_);
  }
  FarmPlan plan(const std::string& elements, double minutes = 5) {
    const ShowList list = read("shots.json", R"({"schema": "bodyopt-shots-1", "defaults": {"basis": "hero.safetensors",
      "clip": "walk.glb", "out": "out/{shot}/{element}.pc2"}, "elements": [)" +
                                                 elements + "]}");
    return plan_show(list, minutes, problems_);
  }
  void expect_problems(const std::vector<std::string>& parts) {
    ASSERT_EQ(problems_.size(), parts.size()) << ::testing::PrintToString(problems_);
    for (std::size_t k = 0; k < parts.size(); ++k) {
      EXPECT_NE(problems_[k].find(parts[k]), std::string::npos) << problems_[k] << " lacks " << parts[k];
    }
  }

  TemporaryFolder folder_;
  std::vector<std::string> problems_;
};

// Lists of earlier versions ask for a mode of the jiggle that is gone.
TEST_F(PlanShow, AFormerKeyIsReadAndLeftOut) {
  const ShowList list = read("a.json", R"({"schema": "bodyopt-shots-1", "defaults": {"basis": "hero.safetensors",
    "clip": "walk.glb", "out": "{shot}.pc2", "jiggle": true, "iterations": 8}, "elements": [
    {"shot": "a", "element": "hero"}, {"shot": "b", "element": "hero", "iterations": 4}]})");
  expect_problems({});
  ASSERT_EQ(list.elements.size(), 2u);
  for (const ShowElement& element : list.elements) EXPECT_FALSE(element.has("iterations"));
  ASSERT_EQ(list.notes.size(), 1u);
  EXPECT_NE(list.notes[0].find("'iterations' has no effect any more"), std::string::npos) << list.notes[0];
}

// A session of the viewport stands for basis, clip and the range that it plays.
TEST_F(PlanShow, ASessionIsItsLead) {
  write("shot.json", R"({"schema": "bodyopt-session-1", "characters": [
    {"basis": "hero.safetensors", "clip": "walk.glb"}], "view": {"playback": {"in": 101}}})");
  write("bad.json", R"({"schema": "bodyopt-session-1", "characters": [{"basis": "walk.glb"}]})");
  const std::string head =
      R"({"schema": "bodyopt-shots-1", "elements": [{"shot": "a", "element": "hero", "out": "a.pc2", )";
  const ShowList list =
      read("a.json", R"({"schema": "bodyopt-shots-1", "defaults": {"basis": "villain.safetensors"}, )" +
                         head.substr(1 + head.find(", ")) + R"("session": "shot.json"}]})");
  FarmPlan planned = plan_show(list, 5, problems_);
  expect_problems({});
  ASSERT_EQ(planned.tasks.size(), 1u);
  const FarmStep& step = planned.tasks[0].steps.at(0);
  EXPECT_EQ(step.frames, 140u);
  const std::vector<std::string> begin(step.arguments.begin(), step.arguments.begin() + 5);
  EXPECT_EQ(begin,
            (std::vector<std::string>{"eval", "--session", (folder_ / "shot.json").string(), "--frames", "101-240"}));
  write_plan(planned, folder_.path());
  EXPECT_EQ(read_plan(folder_.path()).tasks[0].steps[0].arguments, step.arguments);

  read("b.json", head + R"("session": "shot.json", "clip": "walk.glb"}]})");
  for (const char* session : {"bad.json", "none.json"}) {
    plan_show(read("c.json", head + R"("session": ")" + session + R"("}]})"), 5, problems_);
  }
  expect_problems({"leave out 'basis' and 'clip'", "walk.glb", "none.json"});
}

TEST_F(PlanShow, ASessionThatJigglesIsToldWithoutIt) {
  write("hero.dynamics.safetensors", "is there");
  for (const char* on : {"false", "true"}) {
    write("shot.json", concat(R"({"schema": "bodyopt-session-1", "view": {"jiggle": {"on": )", on,
                              R"(}}, "characters": [{"basis": "hero.safetensors", "clip": "walk.glb"}]})"));
    const FarmPlan planned = plan_show(read("a.json", R"({"schema": "bodyopt-shots-1", "elements": [
      {"shot": "a", "element": "hero", "out": "a.pc2", "session": "shot.json"}]})"),
                                       5, problems_);
    expect_problems({});
    ASSERT_EQ(planned.notes.size(), on == std::string("true") ? 1u : 0u);
    for (const std::string& note : planned.notes) {
      EXPECT_TRUE(note.starts_with("elements[0] (a, hero): ") && note.find("--jiggle") != std::string::npos) << note;
    }
  }
}

// At the rate that the session has to the last digit.
TEST_F(PlanShow, ASessionsRateIsNotRounded) {
  const Basis basis = bodyopt::testing::small_basis();
  Clip clip;
  clip.fps = 0.0010004;
  clip.poses.assign(2001, bind_pose(basis.skeleton));
  write_clip(clip, basis.skeleton, folder_ / "slow.glb");
  write("shot.json", R"({"schema": "bodyopt-session-1", "fps": 0.0010004, "characters": [
    {"basis": "hero.safetensors", "clip": "slow.glb"}]})");
  const FarmPlan planned = plan_show(read("a.json", R"({"schema": "bodyopt-shots-1", "elements": [
    {"shot": "a", "element": "hero", "out": "a.pc2", "session": "shot.json"}]})"),
                                     5, problems_);
  expect_problems({});
  ASSERT_EQ(planned.tasks.size(), 1u);
  EXPECT_EQ(planned.tasks[0].steps.at(0).frames, 2001u);
}

// Of a character that nobody trained, too: it plays its own clip, and wears its own meshes. Its jiggle is refused.
TEST_F(PlanShow, ASessionsLeadNeedsNoTraining) {
  write("shot.json", R"({"schema": "bodyopt-session-1", "characters": [{}], "view": {"playback": {"in": 3}}})");
  const std::string head =
      R"({"schema": "bodyopt-shots-1", "elements": [{"shot": "a", "element": "arm", "out": "a.pc2", "session": "shot.json")";
  const FarmPlan planned = plan_show(read("a.json", head + "}]}"), 5, problems_);
  expect_problems({});
  ASSERT_EQ(planned.tasks.size(), 1u);
  EXPECT_EQ(planned.tasks[0].steps.at(0).frames, 142u);
  plan_show(read("b.json", head + R"(, "jiggle": true}]})"), 5, problems_);
  expect_problems({"its lead is not trained"});
}

TEST_F(PlanShow, ThreeFormsOfAListAreOne) {
  const ShowList json = read("a.json", R"({"schema": "bodyopt-shots-1", "defaults": {"basis": "hero.safetensors",
    "clip": "walk.glb", "out": "{shot}.pc2", "jiggle": true}, "elements": [
    {"shot": "a, \"b\"\n", "element": "hero", "frames": "1-5"},
    {"shot": "c", "element": "hero", "level": 1, "jiggle": false, "gravity_change": [0, -1.5, 0]}]})");
  const ShowList lines = read(
      "a.jsonl", R"({"defaults": {"basis": "hero.safetensors", "clip": "walk.glb", "out": "{shot}.pc2", "jiggle": true}}

{"shot": "a, \"b\"\n", "element": "hero", "frames": "1-5"}
{"shot": "c", "element": "hero", "level": 1, "jiggle": false, "gravity_change": [0, -1.5, 0]}
)");
  const ShowList table = read("a.csv",
                              "shot,element,basis,clip,out,jiggle,frames,level,gravity_change\r\n"
                              "*,hero,hero.safetensors,walk.glb,{shot}.pc2,true,,,\r\n"
                              "\"a, \"\"b\"\"\n\",,,,,,1-5,,\r\nc,,,,,false,,1,0 -1.5 0\r\n");
  expect_problems({});
  for (const ShowList* list : {&json, &lines, &table}) {
    ASSERT_EQ(list->elements.size(), 2u);
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_EQ(list->elements[k].shot, json.elements[k].shot);
      EXPECT_EQ(list->elements[k].frames, json.elements[k].frames);
      EXPECT_EQ(list->elements[k].basis, (folder_ / "hero.safetensors").string());
      EXPECT_EQ(list->elements[k].out, json.elements[k].out);
      EXPECT_EQ(list->elements[k].options, json.elements[k].options);
    }
  }
  EXPECT_EQ(json.elements[0].out, (folder_ / "a, \"b\"\n.pc2").string());
  EXPECT_EQ(json.elements[0].options, (decltype(json.elements[0].options){{"jiggle", {}}}));
  EXPECT_EQ(json.elements[1].options.at("gravity-change"), (std::vector<std::string>{"0", "-1.5", "0"}));
}

// As spreadsheets write them: a byte order mark is no part of a key, and other separators are told.
TEST_F(PlanShow, ATableOfASpreadsheetIsReadOrToldWhyNot) {
  const std::string rows = "shot,element,basis,clip,out\r\na,b,hero.safetensors,walk.glb,a.pc2\r\n";
  const std::string line = R"({"shot": "a", "element": "b", "basis": "b", "clip": "c", "out": "a.pc2"})";
  EXPECT_EQ(read("a.csv", "\xef\xbb\xbf" + rows).elements.size(), 1u);
  EXPECT_EQ(read("a.jsonl", "\xef\xbb\xbf" + line).elements.size(), 1u);
  expect_problems({});
  for (const auto& [separator, name] : {std::pair(';', "semicolons"), {'\t', "tabs"}}) {
    std::string other = rows;
    std::ranges::replace(other, ',', separator);
    try {
      read("b.csv", other);
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::file);
      EXPECT_NE(
          std::string(error.what()).find(concat("row 1: its columns are separated by ", name, ", expected commas")),
          std::string::npos)
          << error.what();
    }
  }
}

TEST_F(PlanShow, SaysAllThatIsWrongAtOnce) {
  plan(R"({"shot": "1", "element": "x", "frames": "1-300"},
          {"shot": "2", "element": "x", "frames": "1:10"},
          {"shot": "3", "element": "x", "frames": "1-10,5-20"},
          {"shot": "4", "element": "x", "frmaes": "1-10"},
          {"shot": "5", "element": "x", "clip": "gone.glb"},
          {"shot": "6", "element": "x", "level": 3},
          {"shot": "7", "element": "x", "out": "same.pc2"},
          {"shot": "8", "element": "x", "out": "same.pc2"},
          {"shot": "9", "element": "../../x"},
          {"shot": "10", "element": "x", "out": "walk.glb/x.pc2"},
          {"shot": "11", "element": "x", "device": "--out"},
          {"shot": "12", "element": "x", "jiggle": true},
          {"shot": "13", "element": "x", "frames": "1-10"})");
  std::sort(problems_.begin(), problems_.end());
  std::vector<std::string> named;
  for (const char* part :
       {"frmaes", "asks for frame 241", "':' is refused", "overlap", "gone.glb", "levels 0 to 0", "as does",
        "cannot be part of a file's name", "cannot be written into", "looks like an option", "dynamics"}) {
    for (const std::string& problem : problems_) {
      if (problem.find(part) == std::string::npos) continue;
      named.emplace_back(part);
      break;
    }
  }
  EXPECT_EQ(named.size(), 11u) << ::testing::PrintToString(problems_);
  EXPECT_EQ(problems_.size(), 11u) << ::testing::PrintToString(problems_);
}

// The basis is read before the clip that moves it, and so on.
TEST_F(PlanShow, OneMistakeOfAnElementHidesNoOther) {
  plan(R"({"shot": "1", "element": "x", "basis": "gone.safetensors", "clip": "walk.glb#wlak", "out": "x.obj"})");
  expect_problems({"does not end in", "gone.safetensors", "has no clip 'wlak'"});
  problems_.clear();
  plan(R"({"shot": "1", "element": "x", "basis": "gone.safetensors", "clip": "walk.bvh", "frames": "1-4,2-5"})");
  expect_problems({"overlap", "gone.safetensors", "walk.bvh"});
}

// As eval has it, but before anything runs.
TEST_F(PlanShow, AnOutputTakesThePlaceOfNoInputAndNoOtherFile) {
  write("body.glb", "glTF, a character");
  plan(R"({"shot": "1", "element": "x", "out": "walk.glb"},
          {"shot": "2", "element": "x", "out": "./skin.glb", "character": "skin.glb"},
          {"shot": "3", "element": "x", "out": "body.glb"},
          {"shot": "4", "element": "x", "out": "new.glb"})");
  expect_problems({"walk.glb would write over", "skin.glb would write over", "holds no shapes that bodyopt wrote"});
}

// Parts of a .glb, of an .mdd or of a rig cannot be joined.
TEST_F(PlanShow, WhatCannotBeJoinedIsNotCut) {
  for (const char* out :
       {R"("out": "a.glb")", R"("out": "a.mdd")", R"("out": "a.usda", "character": "hero.glb", "rigged": true)"}) {
    const FarmPlan whole = plan(concat(R"({"shot": "1", "element": "a", "frame_ms": 1000, )", out, "}"), 1);
    expect_problems({});
    ASSERT_EQ(whole.tasks.size(), 1u) << out;
    EXPECT_EQ(whole.tasks[0].steps.at(0).frames, 240u);
  }
  plan(R"({"shot": "1", "element": "a", "out": "a.obj"})");
  expect_problems({"does not end in .pc2, .mdd, .usda or .glb"});
}

TEST_F(PlanShow, PacksShortElementsAndCutsLongOnes) {
  const FarmPlan short_ones = plan(R"({"shot": "1", "element": "a"}, {"shot": "2", "element": "a"})");
  expect_problems({});
  ASSERT_EQ(short_ones.tasks.size(), 1u);
  EXPECT_EQ(short_ones.tasks[0].steps.size(), 2u);
  EXPECT_FALSE(short_ones.joins);

  const FarmPlan cut = plan(R"({"shot": "1", "element": "a", "frame_ms": 1000, "frames": "11-230"})", 1);
  ASSERT_EQ(cut.tasks.size(), 5u);
  ASSERT_TRUE(cut.joins);
  std::vector<int> frames, parts;
  for (const FarmTask& task : cut.tasks) {
    const std::vector<std::string>& words = task.steps[0].arguments;
    if (words[0] != "eval") continue;
    const auto range = std::find(words.begin(), words.end(), "--frames");
    const std::vector<int> more = parse_frame_range(*(range + 1));
    frames.insert(frames.end(), more.begin(), more.end());
    EXPECT_EQ(task.wave, 0);
  }
  EXPECT_EQ(frames, parse_frame_range("11-230"));
  EXPECT_EQ(cut.tasks.back().wave, 1);
  EXPECT_EQ(cut.tasks.back().steps[0].arguments.size(), 1u + 4 + 3);
}

TEST_F(PlanShow, WhatIsWrittenReadsBack) {
  const FarmPlan plan = this->plan(R"({"shot": "$(touch x) 'q'\n\"", "element": "a", "frame_ms": 1000})", 1);
  expect_problems({});
  write_plan(plan, folder_.path());
  const FarmPlan read = read_plan(folder_.path());
  ASSERT_EQ(read.tasks.size(), plan.tasks.size());
  for (std::size_t k = 0; k < plan.tasks.size(); ++k) {
    EXPECT_EQ(read.tasks[k].name(), plan.tasks[k].name());
    EXPECT_EQ(read.tasks[k].steps[0].arguments, plan.tasks[k].steps[0].arguments);
    EXPECT_EQ(read.tasks[k].steps[0].out, plan.tasks[k].steps[0].out);
  }
}

TEST(Slurm, WavesWaitForWhatTheyNeed) {
  std::vector<FarmTask> tasks;
  for (int lane = 0; lane < 1502; ++lane) tasks.push_back({0, lane, {}});
  tasks.push_back({1, 3, {}});
  tasks.push_back({1, 5, {}});
  tasks.push_back({2, 5, {}});
  tasks.push_back({3, 0, {}});
  std::vector<const FarmTask*> all;
  for (const FarmTask& task : tasks) all.push_back(&task);
  const auto arrays = slurm_arrays(all, "a show; rm -rf $HOME", true, "/p %x",
                                   {.needs = {.cpus = 2, .tasks_per_gpu = 4}, .sbatch = {}});
  const auto has = [](const SlurmArray& array, const std::string& word) {
    return std::find(array.words.begin(), array.words.end(), word) != array.words.end();
  };
  ASSERT_EQ(arrays.size(), 6u);
  EXPECT_TRUE(has(arrays[0], "--array=0-2,4,6-999"));
  EXPECT_TRUE(has(arrays[1], "--array=0-501"));
  EXPECT_EQ(arrays[1].words.back(), "1000");
  EXPECT_TRUE(has(arrays[2], "--array=3,5"));
  EXPECT_TRUE(arrays[2].after.empty());
  EXPECT_EQ(arrays[3].after, std::vector<std::size_t>{2});
  EXPECT_EQ(arrays[4].after, std::vector<std::size_t>{3});
  EXPECT_EQ(arrays[5].after, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
  EXPECT_TRUE(has(arrays[0], "--gres=shard:1"));
  EXPECT_TRUE(has(arrays[0], "--output=/p %%x/logs/%A_%a.log"));
  EXPECT_TRUE(has(arrays[0], "--job-name=bodyopt-a_show__rm_-rf__HOME"));
}

// The script is what a shell sees: names in it must stay names.
TEST(Slurm, NamesInTheScriptAreNotRun) {
  const TemporaryFolder folder;
  const std::string evil = (folder / "plan $(touch hit) `touch hit` ' \" \n;touch hit;").string();
  const std::string script = slurm_script("/bin/echo", evil);
  std::ofstream(folder / "task.sh") << script;
  const CommandResult result = run_command(
      {"env", "-C", folder.path().string(), "SLURM_ARRAY_TASK_ID=7", "sh", (folder / "task.sh").string(), "2", "1000"},
      20);
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.output, "farm run " + evil + " 2.1007\n");
  EXPECT_FALSE(std::filesystem::exists(folder / "hit"));
}

TEST(RunCommand, EndsWhatTakesTooLong) {
  EXPECT_EQ(run_command({"sh", "-c", "echo out; echo err >&2; exit 3"}, 20).exit_code, 3);
  EXPECT_THROW(run_command({"sleep", "30"}, 0.2), Error);
  EXPECT_THROW(run_command({"no_such_program_at_all"}, 1), Error);
}

TEST(TaskRecord, OrderAndNamesOfFilesDoNotMatterButTheRestDoes) {
  using Words = std::vector<std::string>;
  const std::uint64_t options =
      task_options(Words{"a.safetensors", "--clip", "x.glb#walk", "--frames", "1-5", "--out", "o.pc2"});
  EXPECT_EQ(options, task_options(Words{"b.safetensors", "--frames", "1-5", "--out", "p.pc2", "--clip", "y.glb#walk",
                                        "--resume"}));
  EXPECT_NE(options, task_options(Words{"a.safetensors", "--clip", "x.glb#run", "--frames", "1-5", "--out", "o.pc2"}));
  EXPECT_NE(options, task_options(Words{"a.safetensors", "--clip", "x.glb#walk", "--frames", "1-6", "--out", "o.pc2"}));
  EXPECT_NE(options, task_options(Words{"a.safetensors", "--clip", "x.glb#walk", "--frames", "1-5", "--jiggle", "--out",
                                        "o.pc2"}));
}

TEST(FarmStatus, KnowsWhatIsDoneStaleFailedAndRotten) {
  const TemporaryFolder folder;
  const std::string out = (folder / "o.pc2").string(), in = (folder / "i.glb").string();
  std::ofstream(out) << "output";
  std::ofstream(in) << "input";
  const FarmStep step{"s", "e", {"join", in, "--out", out}, out};
  const std::vector<std::string> words(step.arguments.begin() + 1, step.arguments.end());
  EXPECT_EQ(status_of(step, "1", true).state, StepState::missing);
  TaskRun(out, "1", words, {in}).fail(Error(ErrorKind::mismatch, "no"));
  EXPECT_EQ(status_of(step, "1", true).state, StepState::failed);
  EXPECT_FALSE(status_of(step, "1", true).may_be_retried);
  EXPECT_TRUE(status_of(step, "2", true).may_be_retried);
  TaskRun(out, "1", words, {in}).finish({out}, Json::object());
  EXPECT_EQ(status_of(step, "1", true).state, StepState::done);
  EXPECT_EQ(status_of(step, "2", true).state, StepState::stale);

  // A clock that was set back changes nothing; bytes that rot are found by those who read.
  const auto time = std::filesystem::last_write_time(out);
  std::filesystem::last_write_time(out, time - std::chrono::hours(9000));
  EXPECT_EQ(status_of(step, "1", false).state, StepState::done);
  std::filesystem::last_write_time(out, time);
  std::ofstream(out) << "0utput";
  std::filesystem::last_write_time(out, time);
  EXPECT_EQ(status_of(step, "1", false).state, StepState::done);
  EXPECT_EQ(status_of(step, "1", true).state, StepState::stale);
  std::ofstream(out) << "output";
  std::ofstream(in) << "input, changed";
  EXPECT_EQ(status_of(step, "1", false).state, StepState::stale);
}

}  // namespace
}  // namespace bodyopt::farm
