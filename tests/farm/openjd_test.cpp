// The template of Open Job Description: what is generated keeps the rules, and the rules refuse what breaks them.
#include "farm/openjd.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

Json job_of(const std::string& show, const TaskNeeds& needs = {}) {
  FarmPlan plan{show, {}, true};
  for (const int lane : {0, 1, 2, 5}) plan.tasks.push_back({0, lane, {}});
  plan.tasks.push_back({1, 5, {}});
  plan.tasks.push_back({2, 0, {}});
  return openjd_template(plan, "/a folder/{{with}} $(odd) names", "/usr/bin/bodyopt", needs);
}

TEST(Openjd, WhatIsGeneratedKeepsTheRules) {
  for (const std::string& show :
       {std::string("show"), std::string(300, 'x'), std::string("a\n{{b}}\xff"), std::string()}) {
    EXPECT_EQ(check_openjd(job_of(show)), std::vector<std::string>{}) << show;
  }
  const Json job = job_of("show");
  ASSERT_EQ(job["steps"].size(), 3u);
  EXPECT_EQ(job["steps"][0]["parameterSpace"]["taskParameterDefinitions"][0]["range"], "0-2,5");
  EXPECT_EQ(job["steps"][1]["dependencies"][0]["dependsOn"], "wave 0");
  EXPECT_EQ(job["steps"][1]["script"]["actions"]["onRun"]["args"][3], "1.{{Task.Param.Lane}}");
}

TEST(Openjd, HostsHaveWhatATaskNeeds) {
  const Json job = job_of("show", {.cpus = 4, .tasks_per_gpu = 1});
  EXPECT_TRUE(check_openjd(job).empty());
  EXPECT_EQ(job["steps"][2]["hostRequirements"]["amounts"],
            Json::parse(R"([{"name": "amount.worker.vcpu", "min": 4}, {"name": "amount.worker.gpu", "min": 1}])"));
  EXPECT_EQ(job_of("show")["steps"][0]["hostRequirements"]["amounts"].size(), 1u);
  EXPECT_THROW(job_of("show", {.cpus = 1, .tasks_per_gpu = 2}), Error);
}

TEST(Openjd, TheRulesRefuseWhatBreaksThem) {
  const auto expect_refused = [](const std::string& pointer, const Json& value) {
    Json job = job_of("show");
    job[Json::json_pointer(pointer)] = value;
    EXPECT_EQ(check_openjd(job).size(), 1u) << pointer << " = " << value;
  };
  const std::string lanes = "/steps/0/parameterSpace/taskParameterDefinitions/0/",
                    run = "/steps/0/script/actions/onRun/";
  expect_refused("/specificationVersion", "jobtemplate-2024-01");
  expect_refused("/name", std::string(129, 'x'));
  expect_refused("/name", "a\nb");
  expect_refused("/steps/1/dependencies/0/dependsOn", "wave 7");
  expect_refused("/steps/1/dependencies/0/dependsOn", "wave 1");
  expect_refused(lanes + "range", "0-2:2");
  expect_refused(lanes + "range", "");
  expect_refused(lanes + "type", "FLOAT");
  expect_refused(run + "command", "");
  expect_refused(run + "args/2", "{{Param.Paln}}");
  expect_refused("/steps/0/hostRequirements/amounts/0/name", "amount.worker.gpus");
  expect_refused("/steps/0/hostRequirements/amounts/0/min", 0);
  expect_refused("/stepps", 1);
}

}  // namespace
}  // namespace bodyopt
