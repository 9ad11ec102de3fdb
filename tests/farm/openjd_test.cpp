// The template of Open Job Description: what is generated keeps the rules, and the rules refuse what breaks them.
#include "farm/openjd.h"

#include <gtest/gtest.h>

namespace bodyopt {
namespace {

Json job_of(const std::string& show) {
  FarmPlan plan{show, {}, true};
  for (const int lane : {0, 1, 2, 5}) plan.tasks.push_back({0, lane, {}});
  plan.tasks.push_back({1, 5, {}});
  plan.tasks.push_back({2, 0, {}});
  return openjd_template(plan, "/a folder/{{with}} $(odd) names", "/usr/bin/bodyopt");
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
  expect_refused("/stepps", 1);
}

}  // namespace
}  // namespace bodyopt
