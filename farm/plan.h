// A show cut into tasks that a queue runs: plan.json in a folder, beside which a queue's own files lie.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace bodyopt {

// The list of what a show needs evaluated, as its coordinators write it: JSON, JSON lines or CSV.

// One character in one shot. Paths are absolute.
struct ShowElement {
  std::string place;  // "elements[3]" or "line 5", for messages
  std::string shot, element;
  std::string session;  // of the viewport: in place of the basis and the clip; empty: there is none
  std::optional<int> session_in{}, session_out{};  // the range that it plays, once it is read
  double session_unit = 0;                         // as SessionPosing::unit
  std::string basis, clip, frames, out;
  double frame_ms = 0;  // what a frame takes on one core; 0: as estimated
  // Further options of `bodyopt eval` by name, without "--"; flags have an empty list.
  std::map<std::string, std::vector<std::string>> options;

  bool has(const char* option) const { return options.contains(option); }
  // The option's only value, or `otherwise`.
  std::string option(const char* name, const std::string& otherwise) const;
};

struct ShowList {
  std::string show;  // a name for queues
  std::vector<ShowElement> elements;
  std::vector<std::string> notes;  // for the user
};

// The ending tells the format: .jsonl, .csv, or else JSON. Faults of an element go to `problems`, a sentence each, and
// the element is left out. Throws Error(file) where the file as a whole cannot be read.
ShowList read_show_list(const std::filesystem::path& path, std::vector<std::string>& problems);

// The records of comma-separated values (RFC 4180): quoted fields may hold commas, quotes and ends of lines. Throws
// Error(file) whose text starts with `origin`.
std::vector<std::vector<std::string>> parse_csv(const std::string& text, const std::string& origin);

// One command: `bodyopt eval ...` of an element or a part of one, or `bodyopt join ...` of its parts.
struct FarmStep {
  std::string shot, element;
  std::vector<std::string> arguments;  // after "bodyopt"
  std::string out;
  std::size_t frames = 0;
  double seconds = 0;         // on one core, as estimated
  bool is_delivered = false;  // `out` is what the list asks for, and not a part of it
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
  std::vector<FarmTask> tasks;  // by wave, then by lane
  bool joins = false;           // the last wave joins

  int wave_count() const { return tasks.empty() ? 0 : tasks.back().wave + 1; }
};

// Checks all elements, and says all that is wrong: a sentence each in `problems`. Reads every basis and clip once.
FarmPlan plan_show(const ShowList& list, double minutes_per_task, std::vector<std::string>& problems);

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
};

// Returns the sound elements. Faults of the others go to `problems`, a sentence each. Every file is read once.
std::vector<CheckedElement> check_show(const ShowList& list, std::vector<std::string>& problems);

}  // namespace bodyopt
