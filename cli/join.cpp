// bodyopt join: caches of the parts of a shot to one of the whole.
#include <nlohmann/json.hpp>

#include "assets/caches/join_caches.h"
#include "cli/arguments/common.h"
#include "cli/arguments/shot_arguments.h"
#include "cli/run_command.h"
#include "runtime/core/error.h"

namespace bodyopt::cli {
namespace {

struct JoinArguments {
  std::string out;
  std::vector<std::string> parts;
  TaskArguments task;
  JsonOption json;
};

void join(const JoinArguments& arguments, const farm::TaskRun* task) {
  const std::vector<std::filesystem::path> parts(arguments.parts.begin(), arguments.parts.end());
  for (const std::filesystem::path& part : parts) refuse_overwriting(arguments.out, part);
  join_caches(parts, arguments.out);
  if (task != nullptr) {
    task->require_same_inputs();
    task->finish({arguments.out}, Json::object());
  }
}

void run(JoinArguments arguments) {
  arguments.task.begin();
  arguments.json.require_writable();
  std::optional<farm::TaskRun> task;
  if (arguments.task.resume) {
    task.emplace(arguments.out, BODYOPT_VERSION, arguments.task.given,
                 std::vector<std::filesystem::path>(arguments.parts.begin(), arguments.parts.end()));
  }
  const bool done = task && task->done({arguments.out});
  const std::string doing = done ? "already done: " : arguments.task.pretend ? "would join to " : "wrote ";
  try {
    if (!done && !arguments.task.pretend) join(arguments, task ? &*task : nullptr);
  } catch (const Error& error) {
    if (task) task->fail(error);
    throw;
  }
  arguments.json.emit({{"cache", arguments.out}, {"parts", arguments.parts}, {"done_before", done}},
                      doing + arguments.out + "\n");
}

void declare_join(CLI::App& verb, JoinArguments& arguments) {
  add_required(verb, "parts", arguments.parts, "CACHE...",
               "Caches that 'eval' wrote of parts of a shot, all .pc2 or all .usda");
  add_option(verb, "--out", arguments.out, "FILE", "Cache to write, with the ending of the parts")->required();
  arguments.task.add(verb);
  arguments.json.add(verb);
}

}  // namespace

void add_join(CLI::App& app) {
  const auto [verb, arguments] = add_verb<JoinArguments, JoinArguments>(
      app, "join", "Join caches of the parts of a shot to one of the whole", run);
  declare_join(verb, arguments);
}

void join_step(const farm::FarmStep& step, const std::string& progress) {
  run(read_step<JoinArguments>(declare_join, step, progress));
}

}  // namespace bodyopt::cli
