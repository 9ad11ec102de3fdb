// What a queue is asked for by each task.
#pragma once

namespace bodyopt {

struct TaskNeeds {
  int cpus = 1;           // cores
  int tasks_per_gpu = 0;  // 0: no GPU; more than one: a share of one, which of our queues Slurm alone knows
};

}  // namespace bodyopt
