// What a show has come to: a line per element, and the frames of it that are worth a look. Made of what lies beside the
// outputs alone.
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

// One element of one shot; where it was cut into parts, of all of them together.
struct ElementSummary {
  std::string shot, element, out;
  StepState state = StepState::missing;  // of what is delivered
  std::optional<TaskFailure> failure;    // of it, or of a part
  std::size_t frames = 0;                // that are evaluated
  double seconds = 0;                    // that tasks took for them
  double peak_memory_mib = 0;
  std::string device;
  std::vector<int> outside;  // frames that leave the trained range
  double worst_outside = 0;  // standard deviations
};

struct WorthyFrame {
  const FarmStep* step = nullptr;  // that evaluated it
  int frame = 0;
  std::uint32_t sample = 0;    // of the step's cache
  double expected_rms_mm = 0;  // 0: not known
  double outside = 0;          // standard deviations
};

// Frames of one clip, as `simulate` takes them.
struct FramesToSimulate {
  std::string basis, clip;
  std::vector<std::string> options;  // of how the clip is read: --fps 24
  std::vector<int> frames;           // rising
};

struct ShowSummary {
  std::vector<ElementSummary> elements;   // in the order of the plan
  std::vector<WorthyFrame> worth_a_look;  // worst first
  std::vector<FramesToSimulate> simulate_next;
};

// `most`: frames worth a look at most. The plan must outlive the result. What of a record cannot be read is left out.
ShowSummary summarize_show(const FarmPlan& plan, const std::vector<std::vector<StepStatus>>& statuses,
                           std::size_t most);

}  // namespace bodyopt
