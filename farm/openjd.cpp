#include "farm/openjd.h"

#include <map>
#include <nlohmann/json.hpp>

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

}  // namespace bodyopt
