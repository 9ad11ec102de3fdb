// The options of verbs that a farm runs.
#pragma once

#include <string>
#include <vector>

#include "cli/arguments/common.h"
#include "farm/task_run.h"

namespace bodyopt::cli {

// [--resume] [--pretend] [--progress STYLE]
struct TaskArguments {
  bool resume = false, pretend = false;
  std::string progress = "auto";
  std::vector<std::string> given;  // the command line after the verb, for task_options()

  void add(CLI::App& verb);
  // Call it first: from then on, progress is shown as asked.
  void begin();
};

}  // namespace bodyopt::cli
