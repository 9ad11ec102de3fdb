// What a show has come to, from the records beside its outputs.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "farm/task_run.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::farm {
namespace {

class ShowOnDisk : public ::testing::Test {
 protected:
  void SetUp() override { std::ofstream(folder_ / "walk.glb") << "clip"; }

  FarmStep step(const std::string& shot, const std::string& frames, bool is_delivered) const {
    FarmStep made{shot, "hero", {}, (folder_ / (shot + frames + ".pc2")).string()};
    made.arguments = {"eval",  "hero.safetensors", "--clip", clip_, "--frames", frames, "--fps", "25", "--out",
                      made.out};
    made.frames = 10;
    made.is_delivered = is_delivered;
    return made;
  }
  TaskRun run(const FarmStep& of) const {
    return {of.out, "1", {of.arguments.begin() + 1, of.arguments.end()}, {clip_}};
  }
  void do_step(const FarmStep& of, const std::string& worthy, const std::string& outside) const {
    std::ofstream(of.out) << "cache";
    run(of).finish({of.out}, Json::parse(R"({"seconds": 2.5, "peak_memory_mib": 100, "worst_outside": 1.5,
      "device": "CPU", "outside_frames": ")" +
                                         outside + R"(", "worth_a_look": )" + worthy + "}"));
  }
  ShowSummary summary(std::size_t most) { return summarize_show(plan_, status_of(plan_, "1", false), most); }

  TemporaryFolder folder_;
  std::string clip_ = (folder_ / "walk.glb").string();
  FarmPlan plan_{"show", {}, true};
};

TEST_F(ShowOnDisk, PartsAreOneElementAndTheWorstFramesComeFirst) {
  const FarmStep first = step("a", "1-10", false), second = step("a", "11-20", false), whole = step("a", "1-20", true),
                 other = step("b", "5-14", true), failed = step("c", "1-10", true);
  plan_.tasks = {{0, 0, {first, second}}, {0, 1, {other, failed}}, {1, 0, {whole}}};
  do_step(first, R"([{"frame": 3, "expected_rms_mm": 2, "outside": 0}])", "2-3");
  do_step(second, R"([{"frame": 12, "expected_rms_mm": 7, "outside": 1.5}])", "12");
  do_step(other,
          R"([{"frame": 14, "expected_rms_mm": 5, "outside": 0}, {"frame": 6, "expected_rms_mm": 0, "outside": 0}])",
          "");
  run(failed).fail(Error(ErrorKind::mismatch, "another skeleton"));

  const ShowSummary told = summary(3);
  ASSERT_EQ(told.elements.size(), 3u);
  EXPECT_EQ(told.elements[0].state, StepState::missing);  // the parts are not joined
  EXPECT_EQ(told.elements[0].frames, 20u);
  EXPECT_EQ(told.elements[0].seconds, 5);
  EXPECT_EQ(told.elements[0].outside, (std::vector<int>{2, 3, 12}));
  EXPECT_EQ(told.elements[1].state, StepState::done);
  EXPECT_EQ(told.elements[2].state, StepState::failed);
  ASSERT_TRUE(told.elements[2].failure.has_value());
  EXPECT_EQ(told.elements[2].failure->message, "another skeleton");

  ASSERT_EQ(told.worth_a_look.size(), 3u);
  EXPECT_EQ(told.worth_a_look[0].frame, 12);
  EXPECT_EQ(told.worth_a_look[0].sample, 1u);
  EXPECT_EQ(told.worth_a_look[1].frame, 14);
  ASSERT_EQ(told.simulate_next.size(), 1u);
  EXPECT_EQ(told.simulate_next[0].clip, clip_);
  EXPECT_EQ(told.simulate_next[0].options, (std::vector<std::string>{"--fps", "25"}));
  EXPECT_EQ(told.simulate_next[0].frames, (std::vector<int>{3, 12, 14}));
  EXPECT_TRUE(summary(0).simulate_next.empty());
}

// Records are files that anything may have happened to.
TEST_F(ShowOnDisk, WhatCannotBeReadOfARecordIsLeftOut) {
  for (const char* worthy : {R"([{"frame": 99, "expected_rms_mm": 2, "outside": 0}])", R"([7])", R"({})",
                             R"([{"frame": 3, "expected_rms_mm": -1, "outside": 0}])"}) {
    const FarmStep only = step("a", "1-10", true);
    plan_.tasks = {{0, 0, {only}}};
    do_step(only, worthy, "1");
    const ShowSummary told = summary(3);
    EXPECT_EQ(told.elements.at(0).state, StepState::done) << worthy;
    EXPECT_EQ(told.elements.at(0).frames, 0u) << worthy;
    EXPECT_TRUE(told.worth_a_look.empty()) << worthy;
  }
}

}  // namespace
}  // namespace bodyopt::farm
