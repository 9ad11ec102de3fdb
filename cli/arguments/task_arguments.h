// The options of verbs that a farm runs.
#pragma once

#include <string>
#include <vector>

#include "cli/arguments/common.h"
#include "farm/plan.h"
#include "farm/task_run.h"

namespace bodyopt::cli {

// [--resume] [--pretend] [--progress STYLE]
struct TaskArguments {
  bool resume = false, pretend = false;
  std::string progress = "auto";
  std::vector<std::string> given;  // what follows the verb, by which a record knows the work

  void add(CLI::App& verb);
  // Call it first: from then on, progress is shown as asked.
  void begin() const;
};

// Throws Error(usage).
void parse_step(CLI::App& verb, const FarmStep& step, const std::string& progress);

// The arguments of a step's verb, whose options `declare` adds.
template <typename Arguments>
Arguments read_step(void (*declare)(CLI::App&, Arguments&), const FarmStep& step, const std::string& progress) {
  CLI::App verb;
  Arguments arguments;
  declare(verb, arguments);
  parse_step(verb, step, progress);
  arguments.task.given = {step.arguments.begin() + 1, step.arguments.end()};
  return arguments;
}

}  // namespace bodyopt::cli
