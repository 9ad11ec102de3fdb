#include "farm/openjd.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

std::string printable(const std::string& name, std::size_t longest) {
  std::string text;
  for (const char c : name.substr(0, longest)) text += c >= ' ' && c < 127 && c != '{' && c != '}' ? c : '_';
  return text.empty() ? "show" : text;
}

std::string step_name(int wave) { return "wave " + std::to_string(wave); }

Json host_requirements(const TaskNeeds& needs) {
  if (needs.tasks_per_gpu > 1) {
    throw Error(ErrorKind::usage,
                "Open Job Description knows no shares of a GPU: ask for a whole one for each task (1), or for none");
  }
  Json amounts = Json::array({{{"name", "amount.worker.vcpu"}, {"min", needs.cpus}}});
  if (needs.tasks_per_gpu == 1) amounts.push_back({{"name", "amount.worker.gpu"}, {"min", 1}});
  return {{"amounts", amounts}};
}

Json step_of(int wave, const std::vector<int>& lanes, const TaskNeeds& needs) {
  Json step{{"name", step_name(wave)}};
  step["hostRequirements"] = host_requirements(needs);
  if (wave > 0) step["dependencies"] = Json::array({{{"dependsOn", step_name(wave - 1)}}});
  step["parameterSpace"]["taskParameterDefinitions"] =
      Json::array({{{"name", "Lane"}, {"type", "INT"}, {"range", number_ranges(lanes)}}});
  step["script"]["actions"]["onRun"] = {
      {"command", "{{Param.Program}}"},
      {"args",
       {"farm", "run", "{{Param.Plan}}", std::to_string(wave) + ".{{Task.Param.Lane}}", "--progress", "openjd"}},
      {"cancelation", {{"mode", "NOTIFY_THEN_TERMINATE"}, {"notifyPeriodInSeconds", 30}}}};
  return step;
}

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

}  // namespace

Json openjd_template(const FarmPlan& plan, const std::filesystem::path& folder, const std::string& program,
                     const TaskNeeds& needs) {
  std::map<int, std::vector<int>> waves;
  for (const FarmTask& task : plan.tasks) waves[task.wave].push_back(task.lane);
  Json steps = Json::array();
  for (const auto& [wave, lanes] : waves) steps.push_back(step_of(wave, lanes, needs));
  return {{"specificationVersion", "jobtemplate-2023-09"},
          {"name", "bodyopt " + printable(plan.show, 100)},
          {"parameterDefinitions",
           {{{"name", "Plan"},
             {"type", "PATH"},
             {"objectType", "DIRECTORY"},
             {"dataFlow", "INOUT"},
             {"default", folder.string()}},
            {{"name", "Program"}, {"type", "STRING"}, {"default", program}}}},
          {"steps", steps}};
}

std::vector<std::string> check_openjd(const Json& job) { return OpenjdChecker(job).check(); }

}  // namespace bodyopt
