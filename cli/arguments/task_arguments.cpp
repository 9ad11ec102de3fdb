#include "cli/arguments/task_arguments.h"

#include <map>

#include "base/progress.h"

namespace bodyopt::cli {
namespace {

const std::map<std::string, ProgressStyle> kStyles = {{"auto", ProgressStyle::automatic},
                                                      {"bar", ProgressStyle::bar},
                                                      {"lines", ProgressStyle::lines},
                                                      {"json", ProgressStyle::json},
                                                      {"openjd", ProgressStyle::openjd}};

}  // namespace

void TaskArguments::add(CLI::App& verb) {
  const std::string group = "On a farm";
  add_flag(verb, "--resume", resume,
           "Do only what is not done: skip an output whose FILE.done.json says that it was made of these inputs by "
           "these options, go on where a run was interrupted")
      ->group(group);
  add_flag(verb, "--pretend", pretend, "Check everything, say what would be done, and write nothing")->group(group);
  add_option(verb, "--progress", progress, "auto, bar, lines, json or openjd (Open Job Description)")
      ->capture_default_str()
      ->type_name("STYLE")
      ->check(CLI::IsMember(kStyles))
      ->group(group);
}

void TaskArguments::begin() {
  set_progress_style(kStyles.at(progress));
  given = verb_arguments();
}

}  // namespace bodyopt::cli
