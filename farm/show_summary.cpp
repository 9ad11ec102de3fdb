#include "farm/show_summary.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "assets/frame_range.h"
#include "assets/json_file.h"
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

// The words after an option of a step; none where it has it not.
std::vector<std::string> option_of(const FarmStep& step, const std::string& option) {
  auto at = std::ranges::find(step.arguments, option);
  std::vector<std::string> words;
  while (at != step.arguments.end() && ++at != step.arguments.end() && !at->starts_with("--")) words.push_back(*at);
  return words;
}

// What a record tells of the frames that were evaluated.
struct StepFacts {
  double seconds = 0, peak_memory_mib = 0, worst_outside = 0;
  std::string device;
  std::vector<int> outside;
  std::vector<WorthyFrame> worth_a_look;
};

std::vector<WorthyFrame> worthy_frames(const Json& list, const FarmStep& step, const std::filesystem::path& path) {
  const std::vector<int> frames = parse_frame_range(option_of(step, "--frames").at(0));
  std::vector<WorthyFrame> worthy;
  for (const Json& entry : list) {
    const JsonObject object(entry, path, "worth_a_look");
    const int frame = object.integer("frame");
    const auto at = std::ranges::find(frames, frame);
    if (at == frames.end()) object.refuse("names a frame that the task does not have");
    worthy.push_back({&step, frame, static_cast<std::uint32_t>(at - frames.begin()),
                      object.number("expected_rms_mm", 0, 1e9), object.number("outside", 0, 1e12)});
  }
  return worthy;
}

// Nothing where the record is damaged, or of a version that told less.
std::optional<StepFacts> facts_of(const StepStatus& status) {
  if (!status.record || status.step->arguments.front() != "eval") return std::nullopt;
  const std::filesystem::path path = done_beside(status.step->out);
  try {
    const JsonObject summary(status.record->summary, path, "summary");
    StepFacts facts{summary.number("seconds", 0, 1e9),
                    summary.number("peak_memory_mib", 0, 1e9),
                    summary.number("worst_outside", 0, 1e12),
                    summary.text("device"),
                    {},
                    {}};
    const std::string outside = summary.text("outside_frames");
    if (!outside.empty()) facts.outside = parse_frame_range(outside);
    facts.worth_a_look = worthy_frames(summary.array("worth_a_look"), *status.step, path);
    return facts;
  } catch (const Error&) {
    return std::nullopt;
  }
}

bool is_worse(const WorthyFrame& a, const WorthyFrame& b) {
  return std::pair(a.expected_rms_mm, a.outside) > std::pair(b.expected_rms_mm, b.outside);
}

// How `simulate` is to read a clip as `eval` did.
std::vector<std::string> clip_options(const FarmStep& step) {
  std::vector<std::string> words;
  for (const char* option : {"--fps", "--first-frame", "--unit", "--controls", "--joint-map", "--up"}) {
    const std::vector<std::string> values = option_of(step, option);
    if (values.empty()) continue;
    words.emplace_back(option);
    words.insert(words.end(), values.begin(), values.end());
  }
  return words;
}

std::vector<FramesToSimulate> frames_to_simulate(const std::vector<WorthyFrame>& worthy) {
  std::map<std::vector<std::string>, FramesToSimulate> clips;
  for (const WorthyFrame& frame : worthy) {
    if (frame.expected_rms_mm <= 0 && frame.outside <= 0) continue;
    if (option_of(*frame.step, "--clip").empty()) continue;  // of a session, which `simulate` does not read
    const std::string basis = frame.step->arguments.at(1), clip = option_of(*frame.step, "--clip").at(0);
    const std::vector<std::string> options = clip_options(*frame.step);
    std::vector<std::string> key{basis, clip};
    key.insert(key.end(), options.begin(), options.end());
    FramesToSimulate& entry = clips.try_emplace(key, FramesToSimulate{basis, clip, options, {}}).first->second;
    entry.frames = unite_frames(entry.frames, {frame.frame});
  }
  std::vector<FramesToSimulate> list;
  for (auto& [key, entry] : clips) list.push_back(std::move(entry));
  return list;
}

class ShowSummarizer {
 public:
  void add(const StepStatus& status) {
    const FarmStep& step = *status.step;
    const auto [found, is_new] = numbers_.try_emplace({step.shot, step.element}, summary_.elements.size());
    if (is_new) summary_.elements.push_back({step.shot, step.element, "", StepState::missing, {}, 0, 0, 0, "", {}, 0});
    ElementSummary& element = summary_.elements[found->second];
    if (step.is_delivered && element.out.empty()) {  // what rides on the skin is delivered after it
      element.out = step.out;
      element.state = status.state;
    }
    if (status.failure) element.failure = status.failure;
    if (const std::optional<StepFacts> facts = facts_of(status)) count(element, *facts, step.frames);
  }

  ShowSummary finish(std::size_t most) {
    std::vector<WorthyFrame>& worthy = summary_.worth_a_look;
    std::ranges::stable_sort(worthy, is_worse);
    worthy.resize(std::min(most, worthy.size()));
    summary_.simulate_next = frames_to_simulate(worthy);
    return std::move(summary_);
  }

 private:
  void count(ElementSummary& element, const StepFacts& facts, std::size_t frames) {
    element.frames += frames;
    element.seconds += facts.seconds;
    element.peak_memory_mib = std::max(element.peak_memory_mib, facts.peak_memory_mib);
    element.device = facts.device;
    element.outside = unite_frames(element.outside, facts.outside);
    element.worst_outside = std::max(element.worst_outside, facts.worst_outside);
    summary_.worth_a_look.insert(summary_.worth_a_look.end(), facts.worth_a_look.begin(), facts.worth_a_look.end());
  }

  std::map<std::pair<std::string, std::string>, std::size_t> numbers_;  // by shot and element
  ShowSummary summary_;
};

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

ShowSummary summarize_show(const FarmPlan& plan, const std::vector<std::vector<StepStatus>>& statuses,
                           std::size_t most) {
  ShowSummarizer summarizer;
  for (std::size_t t = 0; t < plan.tasks.size(); ++t) {
    for (const StepStatus& status : statuses[t]) summarizer.add(status);
  }
  return summarizer.finish(most);
}

}  // namespace bodyopt
