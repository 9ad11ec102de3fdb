// What jobs of queues are written with, and what they ask for.
#pragma once

#include <string>
#include <vector>

namespace bodyopt {

// Whole numbers as queues take them, of rising ones "0-5,7". Steps are not used: queues disagree on how they are
// written.
std::string number_ranges(const std::vector<int>& numbers);

// A text as one word for sh: nothing in it has a meaning.
std::string quoted_for_shell(const std::string& text);

// What a queue is asked for by each task.
struct TaskNeeds {
  int cpus = 1;           // cores
  int tasks_per_gpu = 0;  // 0: no GPU; more than one: a share of one, which of our queues Slurm alone knows
};

}  // namespace bodyopt
