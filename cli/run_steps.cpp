#include "cli/run_steps.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "cli/arguments/common.h"
#include "runtime/core/error.h"

namespace bodyopt::cli {
namespace {

constexpr double kUncutMinutes = 1e5;  // of a task: no element is cut into parts

// A command of ours in this process; what it prints stands in the log.
int run_step(const FarmStep& step, const std::string& progress) {
  return exit_code_of([&] {
    make_folder(std::filesystem::path(step.out).parent_path());
    std::vector<std::string> words{step.arguments.begin() + 1, step.arguments.end()};
    keep_verb_arguments(words);
    words.insert(words.begin(), step.arguments.front());
    words.insert(words.end(), {"--progress", progress});
    std::ranges::reverse(words);  // as CLI11 takes them
    CLI::App app;
    add_eval(app);
    add_join(app);
    try {
      app.parse(words);
    } catch (const CLI::ParseError& error) {
      throw Error(ErrorKind::usage, step.out, ": its command cannot be read: ", error.what());
    }
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
