#include "cli/run_steps.h"

#include <spdlog/spdlog.h>

#include "cli/arguments/common.h"
#include "runtime/core/error.h"

namespace bodyopt::cli {
namespace {

constexpr double kUncutMinutes = 1e5;  // of a task: no element is cut into parts

// In this process; what it prints stands in the log.
int run_step(const FarmStep& step, const std::string& progress) {
  return exit_code_of([&] {
    make_folder(std::filesystem::path(step.out).parent_path());
    (step.arguments.front() == "join" ? join_step : eval_step)(step, progress);
    std::fflush(stdout);
  });
}

}  // namespace

void run_steps(const std::vector<const FarmStep*>& steps, const std::string& progress) {
  int last = 0;
  std::size_t failed = 0;
  for (const FarmStep* step : steps) {
    const int code = run_step(*step, progress);
    if (code == 0) continue;
    ++failed;
    last = code;
    if (code == static_cast<int>(ErrorKind::interrupted)) {
      throw Error(ErrorKind::interrupted, step->out, " was interrupted; the same command goes on with it");
    }
  }
  if (failed > 0) throw Error(static_cast<ErrorKind>(last), format("{} of {} steps failed", failed, steps.size()));
}

void run_show_list(const std::string& file, const std::string& progress) {
  std::vector<std::string> problems;
  const ShowList list = read_show_list(file, problems);
  say(list.notes);
  const FarmPlan plan = plan_show(list, kUncutMinutes, problems);
  for (const std::string& problem : problems) spdlog::error("{}", problem);
  if (!problems.empty()) {
    throw Error(ErrorKind::usage, format("{}: {} problems; nothing is evaluated", file, problems.size()));
  }
  std::vector<const FarmStep*> steps;
  for (const FarmTask& task : plan.tasks) {
    for (const FarmStep& step : task.steps) steps.push_back(&step);
  }
  run_steps(steps, progress);
}

}  // namespace bodyopt::cli
