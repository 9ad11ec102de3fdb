// The options of `eval` for skin that jiggles, with the state files between chunks of a shot.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/arguments/common.h"
#include "farm/plan.h"
#include "farm/task_run.h"
#include "shots/shot_files.h"

namespace bodyopt::cli {

struct JiggleArguments {
  std::string state_out;  // empty: no state is written
  int state_every = 0;    // frames; 0: at the end alone

  void add(CLI::App& verb, shots::JiggleChoice& choice);
  // Throws Error(usage) for options that do not go together or need --jiggle.
  void check(const shots::JiggleChoice& choice) const;
  // Writes a state that is due: after `done` frames, and, once the result is written, at the end. Returns its file.
  std::optional<std::string> write_state_after(const Deformer& deformer, std::size_t done) const;
  std::optional<std::string> write_last_state(const Deformer& deformer) const;
};

// BASIS --clip CLIP with its frames, or --session FILE in place of both.
void add_shot(CLI::App& verb, std::string& basis, ClipArguments& clip, std::string& session);

// --modifiers FILE, --control NAME=VALUE
void add_modifier_options(CLI::App& verb, shots::ShotFiles& files);

// The options of verbs that a farm runs.

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
void parse_step(CLI::App& verb, const farm::FarmStep& step, const std::string& progress);

// The arguments of a step's verb, whose options `declare` adds.
template <typename Arguments>
Arguments read_step(void (*declare)(CLI::App&, Arguments&), const farm::FarmStep& step, const std::string& progress) {
  CLI::App verb;
  Arguments arguments;
  declare(verb, arguments);
  parse_step(verb, step, progress);
  arguments.task.given = {step.arguments.begin() + 1, step.arguments.end()};
  return arguments;
}

}  // namespace bodyopt::cli
