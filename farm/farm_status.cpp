#include "farm/farm_status.h"

#include "base/parallel.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

// What running again does not change: frames, topology, options.
bool is_lasting(int exit_code) {
  return exit_code == static_cast<int>(ErrorKind::mismatch) || exit_code == static_cast<int>(ErrorKind::usage);
}

std::uint64_t options_of(const FarmStep& step) {
  return task_options({step.arguments.begin() + 1, step.arguments.end()});
}

}  // namespace

const char* name_of(StepState state) {
  constexpr const char* kNames[] = {"done", "stale", "stopped", "failed", "missing"};
  return kNames[static_cast<int>(state)];
}

StepStatus status_of(const FarmStep& step, const std::string& version, bool read_all) {
  StepStatus status{&step, StepState::missing, read_record(step.out), std::nullopt, true};
  const std::uint64_t options = options_of(step);
  if (status.record && is_current(status.record->key, version, options, read_all) &&
      is_whole(*status.record, read_all)) {
    status.state = StepState::done;
    return status;
  }
  status.failure = read_failure(step.out);
  if (status.failure) {
    status.state = StepState::failed;
    status.may_be_retried =
        !is_lasting(status.failure->exit_code) || !is_current(status.failure->key, version, options, false);
  } else if (std::filesystem::exists(step.out + ".checkpoint/checkpoint.json")) {
    status.state = StepState::stopped;
  } else if (status.record && std::filesystem::exists(step.out)) {
    status.state = StepState::stale;
  }
  status.record.reset();
  return status;
}

std::vector<std::vector<StepStatus>> status_of(const FarmPlan& plan, const std::string& version, bool read_all) {
  std::vector<std::vector<StepStatus>> statuses(plan.tasks.size());
  parallel_for(plan.tasks.size(), [&](std::size_t t) {
    for (const FarmStep& step : plan.tasks[t].steps) statuses[t].push_back(status_of(step, version, read_all));
  });
  return statuses;
}

}  // namespace bodyopt
