// A show cut into tasks that a queue runs: plan.json in a folder, beside which a queue's own files lie.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "farm/show_list.h"

namespace bodyopt::farm {

// One command: `bodyopt eval ...` of an element or a part of one, or `bodyopt join ...` of its parts.
struct FarmStep {
  std::string shot, element;
  std::vector<std::string> arguments;  // after "bodyopt"
  std::string out;
  std::size_t frames = 0;
  double seconds = 0;         // on one core, as estimated
  bool is_delivered = false;  // `out` is what the list asks for, and not a part of it

  // The words after an option; none where it is not given.
  std::vector<std::string> option(const std::string& name) const;
};

// A task is what a queue starts as one: its steps, one after the other. It needs the task of the same lane in the wave
// before it, whose jiggle it continues. Tasks of a last wave that joins need all others.
struct FarmTask {
  int wave = 0, lane = 0;
  std::vector<FarmStep> steps;

  std::string name() const { return std::to_string(wave) + "." + std::to_string(lane); }
};

struct FarmPlan {
  std::string show;
  std::vector<FarmTask> tasks;       // by wave, then by lane
  bool joins = false;                // the last wave joins
  std::vector<std::string> notes{};  // for who plans, one sentence each; not in the file

  int wave_count() const { return tasks.empty() ? 0 : tasks.back().wave + 1; }
};

// Checks all elements, and says all that is wrong: a sentence each in `problems`. Reads every basis and clip once.
FarmPlan plan_show(const ShowList& list, double minutes_per_task, std::vector<std::string>& problems);

// The plan in its folder.
std::filesystem::path plan_file(const std::filesystem::path& folder);
// Throw Error(file).
void write_plan(const FarmPlan& plan, const std::filesystem::path& folder);
FarmPlan read_plan(const std::filesystem::path& folder);

// Whole numbers as queues take them, of rising ones "0-5,7". Steps are not used: queues write them differently.
std::string number_ranges(const std::vector<int>& numbers);

// A text as one word for sh: nothing in it has a meaning.
std::string quoted_for_shell(const std::string& text);

// Resources that each task asks a queue for.
struct TaskNeeds {
  int cpus = 1;           // cores
  int tasks_per_gpu = 0;  // 0: no GPU; more than one: a share of one, which of our queues Slurm alone knows
};

// An element with all that planning has to know of it.
struct CheckedElement {
  const ShowElement* element = nullptr;
  std::vector<int> frames;
  double frame_ms = 0;                // on one core
  std::vector<std::string> attached;  // names of the meshes attached to the skin
  std::string note{};                 // for who plans; or empty
};

// Returns the sound elements. Faults of the others go to `problems`, a sentence each. Every file is read once.
std::vector<CheckedElement> check_show(const ShowList& list, std::vector<std::string>& problems);

}  // namespace bodyopt::farm
