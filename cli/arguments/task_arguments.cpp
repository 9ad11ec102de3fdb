#include "cli/arguments/task_arguments.h"

#include <algorithm>
#include <map>

#include "base/progress.h"
#include "runtime/core/error.h"

namespace bodyopt::cli {
namespace {

const std::map<std::string, ProgressStyle> kStyles = {{"auto", ProgressStyle::automatic},
                                                      {"bar", ProgressStyle::bar},
                                                      {"lines", ProgressStyle::lines},
                                                      {"json", ProgressStyle::json},
                                                      {"openjd", ProgressStyle::openjd}};

}  // namespace

void TaskArguments::add(CLI::App& verb) {
  given = verb_arguments();
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

void TaskArguments::begin() const { set_progress_style(kStyles.at(progress)); }

void parse_step(CLI::App& verb, const FarmStep& step, const std::string& progress) {
  std::vector<std::string> words{step.arguments.begin() + 1, step.arguments.end()};
  words.insert(words.end(), {"--progress", progress});
  std::ranges::reverse(words);  // as CLI11 takes them
  try {
    verb.parse(words);
  } catch (const CLI::ParseError& error) {
    throw Error(ErrorKind::usage, step.out, ": its command cannot be read: ", error.what());
  }
}

}  // namespace bodyopt::cli
