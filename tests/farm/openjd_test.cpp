// The template of Open Job Description: what is generated keeps the rules, and the rules refuse what breaks them.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "farm/queues.h"
#include "runtime/core/error.h"

namespace bodyopt::farm {
namespace {

// What of the rules below a template breaks, a sentence each; of the specification these are the ones that a generated
// template could break. Version "jobtemplate-2023-09"; only known keys; names of 1 to 128 (steps: 64) characters
// without control characters, of steps and parameters each once; 1 or more steps; dependencies on other steps that
// exist; task parameters INT with a range of 1 or more numbers, as "1-5" and commas, without ':' (there it is a step);
// a command, and fields "{{...}}" that name a parameter of the template; amounts of hosts that the specification names,
// above 0.
class OpenjdChecker {
 public:
  explicit OpenjdChecker(const Json& job) : job_(job) {}

  std::vector<std::string> check() {
    require(job_.value("specificationVersion", "") == "jobtemplate-2023-09",
            "specificationVersion is not jobtemplate-2023-09");
    known_keys(job_, {"specificationVersion", "name", "parameterDefinitions", "steps"}, "the job");
    name(job_, 128, "the job");
    std::set<std::string> fields;
    for (const Json& parameter : job_.value("parameterDefinitions", Json::array())) {
      const std::string known = name(parameter, 64, "a parameter");
      known_keys(parameter, {"name", "type", "default", "objectType", "dataFlow"}, "a parameter");
      require(fields.insert("Param." + known).second, "two parameters are called " + known);
    }
    const Json steps = job_.value("steps", Json::array());
    require(!steps.empty(), "there are no steps");
    std::set<std::string> names;
    for (const Json& step : steps) require(names.insert(name(step, 64, "a step")).second, "two steps have one name");
    for (const Json& step : steps) check_step(step, names, fields);
    return problems_;
  }

 private:
  void require(bool holds, const std::string& problem) {
    if (!holds) problems_.push_back(problem);
  }

  void known_keys(const Json& object, const std::set<std::string>& keys, const std::string& what) {
    for (const auto& [key, value] : object.items()) require(keys.contains(key), what + " has the unknown key " + key);
  }

  std::string name(const Json& object, std::size_t longest, const std::string& what) {
    const std::string text = object.value("name", "");
    const bool is_plain = std::ranges::none_of(text, [](unsigned char c) { return c < ' ' || c == 127; });
    require(!text.empty() && text.size() <= longest && is_plain, what + " has no name, or too long or odd a one");
    return text;
  }

  void check_step(const Json& step, const std::set<std::string>& names, std::set<std::string> fields) {
    const std::string own = step.value("name", "");
    known_keys(step, {"name", "dependencies", "parameterSpace", "script", "hostRequirements"}, own);
    for (const Json& dependency : step.value("dependencies", Json::array())) {
      const std::string on = dependency.value("dependsOn", "");
      require(on != own && names.contains(on), own + " depends on '" + on + "', which is no other step");
    }
    const Json space = step.value("parameterSpace", Json::object());
    for (const Json& parameter : space.value("taskParameterDefinitions", Json::array())) {
      fields.insert("Task.Param." + name(parameter, 64, "a task parameter"));
      const std::string range = parameter.value("range", "");
      require(parameter.value("type", "") == "INT", own + " has a task parameter that is no INT");
      require(!range.empty() && range.find_first_not_of("0123456789-,") == std::string::npos,
              own + " has the range '" + range + "', expected numbers such as 1-5,7");
    }
    check_requirements(step.value("hostRequirements", Json::object()), own);
    const Json run =
        step.value("script", Json::object()).value("actions", Json::object()).value("onRun", Json::object());
    known_keys(run, {"command", "args", "timeout", "cancelation"}, own + "'s onRun");
    require(!run.value("command", "").empty(), own + " has no command");
    check_fields(run.value("command", ""), fields);
    for (const Json& word : run.value("args", Json::array())) check_fields(word.get<std::string>(), fields);
  }

  void check_requirements(const Json& requirements, const std::string& own) {
    known_keys(requirements, {"amounts"}, own + "'s hostRequirements");
    for (const Json& amount : requirements.value("amounts", Json::array())) {
      known_keys(amount, {"name", "min"}, own + "'s amount");
      const std::string named = amount.value("name", "");
      require(named == "amount.worker.vcpu" || named == "amount.worker.gpu", own + " asks hosts for '" + named + "'");
      require(amount.value("min", 0) > 0, own + " asks hosts for no " + named);
    }
  }

  void check_fields(const std::string& text, const std::set<std::string>& fields) {
    for (std::size_t at = 0; (at = text.find("{{", at)) != std::string::npos; ++at) {
      const std::size_t end = text.find("}}", at);
      const std::string field = end == std::string::npos ? text : text.substr(at + 2, end - at - 2);
      require(fields.contains(field), "'" + text + "' names the unknown field '" + field + "'");
    }
  }

  const Json& job_;
  std::vector<std::string> problems_;
};

std::vector<std::string> check_openjd(const Json& job) { return OpenjdChecker(job).check(); }

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
}  // namespace bodyopt::farm
