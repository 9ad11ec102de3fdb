// The job of OpenCue: what is generated keeps the rules, the rules refuse what breaks them, and its command is safe in
// a shell.
#include "farm/opencue.h"

#include <gtest/gtest.h>

#include <pugixml.hpp>

#include "farm/run_command.h"
#include "runtime/core/error.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace {

std::string cue_job(const std::string& show, const std::string& folder = "/plan", const TaskNeeds& needs = {}) {
  FarmPlan plan{show, {}, true};
  for (const int lane : {0, 1, 2, 5}) plan.tasks.push_back({0, lane, {}});
  plan.tasks.push_back({1, 5, {}});
  plan.tasks.push_back({2, 0, {}});
  return opencue_job(plan, folder, "/bin/echo", "artist", needs);
}

TEST(Opencue, WhatIsGeneratedKeepsTheRules) {
  for (const std::string& show :
       {std::string("show"), std::string(300, 'x'), std::string("a\n<b>&\xff"), std::string()}) {
    EXPECT_EQ(check_opencue(cue_job(show)), std::vector<std::string>{}) << show;
  }
  const std::string job = cue_job("show", "/plan", {.cpus = 4, .tasks_per_gpu = 1});
  EXPECT_EQ(check_opencue(job), std::vector<std::string>{});
  for (const char* part : {"<range>0-2,5</range>", "<cores>4.0</cores>", "<gpus>1</gpus>",
                           "<depend type=\"FRAME_BY_FRAME\">", "<depend type=\"LAYER_ON_LAYER\">"}) {
    EXPECT_NE(job.find(part), std::string::npos) << part << " in " << job;
  }
  EXPECT_EQ(cue_job("show").find("<gpus>"), std::string::npos);
  EXPECT_THROW(cue_job("show", "/plan", {.cpus = 1, .tasks_per_gpu = 2}), Error);
}

// The command is what a shell sees, once the frame's number is in it.
TEST(Opencue, NamesInTheCommandAreNotRun) {
  const TemporaryFolder folder;
  const std::string evil = (folder / "plan $(touch hit) `touch hit` ' \" <&>;touch hit;").string();
  const std::string job = cue_job("show", evil);
  ASSERT_EQ(check_opencue(job), std::vector<std::string>{});
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(job.c_str()));
  std::string command = document.child("spec").child("job").child("layers").child("layer").child("cmd").text().get();
  command.replace(command.find("#IFRAME#"), 8, "7");
  const CommandResult result = run_command({"env", "-C", folder.path().string(), "sh", "-c", command}, 20);
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.output, "farm run " + evil + " 0.7\n");
  EXPECT_FALSE(std::filesystem::exists(folder / "hit"));
}

TEST(Opencue, TheRulesRefuseWhatBreaksThem) {
  const auto expect_refused = [](const std::string& text, const std::string& instead) {
    std::string job = cue_job("show");
    const std::size_t at = job.find(text);
    ASSERT_NE(at, std::string::npos) << text;
    job.replace(at, text.size(), instead);
    EXPECT_EQ(check_opencue(job).size(), 1u) << text << " -> " << instead;
  };
  expect_refused("<user>artist<", "<user>root<");
  expect_refused("<shot>farm<", "<shot>a b c<");
  expect_refused("<cores>1.0<", "<cores>1<");
  expect_refused("0-2,5", "5-2,7");
  expect_refused("0-2,5", "0-100000");
  expect_refused("#IFRAME#", "7");
  expect_refused("'/plan'", "'/pl#an'");
  expect_refused("'/plan'", "'/pl&#10;an'");
  expect_refused("<deplayer>wave1<", "<deplayer>wave7<");
  expect_refused("FRAME_BY_FRAME", "JOB_ON_JOB");
  expect_refused("<chunk>1</chunk>", "<chunks>1</chunks>");
}

}  // namespace
}  // namespace bodyopt
