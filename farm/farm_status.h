// What of a plan is done, by what lies beside its outputs and by nothing else.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "farm/plan.h"
#include "farm/task_record.h"

namespace bodyopt {

enum class StepState {
  done,     // whole, of the inputs as they are, by this version
  stale,    // of other inputs or options, by another version, or changed since it was written
  stopped,  // interrupted, with a checkpoint to go on from
  failed,   // with a reason
  missing,  // not begun, or ended without a word
};
const char* name_of(StepState state);

struct StepStatus {
  const FarmStep* step = nullptr;
  StepState state = StepState::missing;
  std::optional<TaskRecord> record;    // of what is done
  std::optional<TaskFailure> failure;  // of what failed
  // False for what failed for its own sake, with inputs that are still the same: to do it again would not help.
  bool may_be_retried = true;
};

// `version`: of the program. Outputs and inputs whose size and time are as they were recorded are taken for unchanged,
// unless `read_all`.
StepStatus status_of(const FarmStep& step, const std::string& version, bool read_all);

// Of every step of every task, in their order; files are looked at side by side.
std::vector<std::vector<StepStatus>> status_of(const FarmPlan& plan, const std::string& version, bool read_all);

}  // namespace bodyopt
