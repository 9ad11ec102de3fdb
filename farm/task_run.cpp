#include "farm/task_run.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/content_hash.h"
#include "base/frame_range.h"
#include "base/json_file.h"
#include "base/parallel.h"
#include "runtime/core/error.h"
#include "runtime/core/file_problem.h"
#include "runtime/core/text.h"
#include "runtime/core/transformed.h"

namespace bodyopt::farm {
namespace {

namespace fs = std::filesystem;

constexpr char kCheckpointSchema[] = "bodyopt-checkpoint-1";

bool is_same(const TaskKey& a, const TaskKey& b) {
  return a.version == b.version && a.options == b.options &&
         std::equal(a.inputs.begin(), a.inputs.end(), b.inputs.begin(), b.inputs.end(),
                    [](const FileStamp& x, const FileStamp& y) { return x.hash == y.hash && x.bytes == y.bytes; });
}

fs::path checkpoint_file(const fs::path& folder) { return folder / "checkpoint.json"; }

struct FileTimes {
  bool is_file = false;
  std::uint64_t bytes = 0;
  std::int64_t modified = 0;
};

FileTimes times_of(const fs::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return {};
  return {true, static_cast<std::uint64_t>(status.st_size),
          std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec};
}

[[noreturn]] void fail(const fs::path& path, const std::string& reason) {
  throw Error(ErrorKind::file, path, ": cannot be read: ", reason,
              " (was it removed, or the folder it is in taken away?)");
}

std::uint64_t hash_of_content(const fs::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);  // a pipe must not block
  if (file < 0) fail(path, std::strerror(errno));
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(), XXH3_freeState);
  XXH3_64bits_reset(state.get());
  std::vector<char> buffer(1 << 20);
  ssize_t got = 0;
  while ((got = read(file, buffer.data(), buffer.size())) > 0) {
    XXH3_64bits_update(state.get(), buffer.data(), static_cast<std::size_t>(got));
  }
  const int reason = errno;
  close(file);
  if (got < 0) fail(path, std::strerror(reason));
  return XXH3_64bits_digest(state.get());
}

constexpr char kDoneSchema[] = "bodyopt-done-1", kFailedSchema[] = "bodyopt-failed-1";

bool is_one_of(const std::string& name, std::initializer_list<const char*> names) {
  return std::ranges::any_of(names, [&](const char* known) { return name == known; });
}

// A clip's file is an input; which clip of it is an option.
std::string clip_within(const std::string& source) {
  const std::size_t hash = source.rfind('#');
  return hash == std::string::npos ? "" : source.substr(hash);
}

Json stamps(const std::vector<FileStamp>& files) {
  return transformed(files, [&](const FileStamp& file) { return to_json(file); });
}

std::vector<FileStamp> read_stamps(const JsonObject& object, const char* key, const fs::path& path) {
  return transformed(object.array(key), [&](const Json& file) { return file_stamp(JsonObject(file, path, key)); });
}

TaskKey made_of(const JsonObject& top) {
  return task_key(JsonObject(top.json().value("made_of", Json()), top.path(), "made_of"), top.path());
}

// Running again does not mend wrong frames, topology or options.
bool is_lasting(int exit_code) {
  return exit_code == static_cast<int>(ErrorKind::mismatch) || exit_code == static_cast<int>(ErrorKind::usage);
}

std::uint64_t options_of(const FarmStep& step) {
  return task_options({step.arguments.begin() + 1, step.arguments.end()});
}

// Facts that a record gives of the frames that were evaluated.
struct StepFacts {
  double seconds = 0, peak_memory_mib = 0, worst_outside = 0;
  std::string device;
  std::vector<int> outside;
  std::vector<WorthyFrame> worth_a_look;
};

std::vector<WorthyFrame> worthy_frames(const Json& list, const FarmStep& step, const std::filesystem::path& path) {
  const std::vector<int> frames = parse_frame_range(step.option("--frames").at(0));
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

// Nothing where the record is damaged, or of a version that recorded less.
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
    const std::vector<std::string> values = step.option(option);
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
    if (frame.step->option("--clip").empty()) continue;  // of a session, which `simulate` does not read
    const std::string basis = frame.step->arguments.at(1), clip = frame.step->option("--clip").at(0);
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
    if (step.is_delivered && element.out.empty()) {  // attached meshes are delivered after the skin
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

TaskRun::TaskRun(fs::path output, const std::string& version, const std::vector<std::string>& arguments,
                 const std::vector<fs::path>& inputs)
    : output_(std::move(output)), key_{version, task_options(arguments), {}} {
  for (const fs::path& input : inputs) key_.inputs.push_back(stamp_file(input));
}

std::optional<TaskRecord> TaskRun::done(const std::vector<fs::path>& outputs) const {
  std::optional<TaskRecord> record = read_record(output_);
  if (!record || !is_same(record->key, key_) || !is_whole(*record, true)) return std::nullopt;
  for (const fs::path& output : outputs) {
    if (std::ranges::none_of(record->outputs, [&](const FileStamp& file) {
          return fs::path(file.path).filename() == output.filename();
        })) {
      return std::nullopt;
    }
  }
  return record;
}

void TaskRun::require_same_inputs() const {
  for (const FileStamp& input : key_.inputs) {
    if (is_unchanged(input, false)) continue;
    throw Error(ErrorKind::interrupted, input.path,
                ": was changed while it was evaluated; nothing is written, for it would be of neither: run again");
  }
}

void TaskRun::finish(const std::vector<fs::path>& outputs, const Json& summary) const {
  TaskRecord record{key_, {}, summary};
  for (const fs::path& output : outputs) record.outputs.push_back(stamp_file(output));
  write_record(record);
  remove_failure(output_);
  remove_checkpoint();
}

void TaskRun::fail(const Error& error) const {
  if (error.kind() == ErrorKind::interrupted) return;
  char host[256] = {};
  gethostname(host, sizeof(host) - 1);
  write_failure({key_, error.exit_code(), error.what(), host}, output_);
}

fs::path TaskRun::checkpoint_folder() const { return fs::path(output_) += ".checkpoint"; }

void TaskRun::write_checkpoint(const Checkpoint& checkpoint, const std::vector<fs::path>& files) const {
  const Json list = transformed(files, [&](const fs::path& file) { return to_json(stamp_file(file)); });
  write_json({{"schema", kCheckpointSchema},
              {"made_of", to_json(key_)},
              {"frames", checkpoint.frames},
              {"files", list},
              {"log", checkpoint.log}},
             checkpoint_file(checkpoint_folder()));
}

std::optional<Checkpoint> TaskRun::read_checkpoint() const {
  const fs::path path = checkpoint_file(checkpoint_folder());
  try {
    const JsonFile top(path, kCheckpointSchema, "the top level", {"schema", "made_of", "frames", "files", "log"});
    if (!is_same(made_of(top), key_)) return std::nullopt;
    for (const Json& file : top.array("files")) {
      if (!is_unchanged(file_stamp(JsonObject(file, path, "files")), true)) return std::nullopt;
    }
    return Checkpoint{static_cast<std::size_t>(top.integer("frames", 1)), top.json().value("log", Json())};
  } catch (const Error&) {
    return std::nullopt;
  }
}

void TaskRun::remove_checkpoint() const {
  std::error_code ignored;
  fs::remove_all(checkpoint_folder(), ignored);
}

FileStamp stamp_file(const fs::path& path) {
  const FileTimes times = times_of(path);
  if (!times.is_file) throw Error(ErrorKind::file, path, ": ", why_unreadable(path));
  return {path.string(), times.bytes, times.modified, hash_of_content(path)};
}

bool is_unchanged(const FileStamp& stamp, bool read_all) {
  const FileTimes times = times_of(stamp.path);
  if (!times.is_file || times.bytes != stamp.bytes) return false;
  if (times.modified == stamp.modified && !read_all) return true;
  try {
    return hash_of_content(stamp.path) == stamp.hash;
  } catch (const Error&) {
    return false;
  }
}

Json to_json(const FileStamp& stamp) {
  return {{"path", stamp.path},
          {"bytes", stamp.bytes},
          {"modified", std::to_string(stamp.modified)},
          {"hash", hexadecimal(stamp.hash)}};
}

FileStamp file_stamp(const JsonObject& object) {
  object.allow({"path", "bytes", "modified", "hash"});
  FileStamp stamp;
  stamp.path = object.name("path");
  stamp.bytes = static_cast<std::uint64_t>(object.number("bytes", 0, 9e15));
  stamp.modified = std::strtoll(object.text("modified").c_str(), nullptr, 10);
  stamp.hash = object.hash("hash");
  return stamp;
}

std::uint64_t task_options(const std::vector<std::string>& arguments) {
  std::vector<std::string> options;  // each with its values
  bool is_left_out = false, is_input = false, is_clip = false;
  for (const std::string& argument : arguments) {
    if (argument.starts_with("--")) {
      is_left_out = is_one_of(argument, {"--out", "--json", "--progress", "--resume", "--pretend"});
      is_clip = argument == "--clip";
      is_input = is_one_of(
          argument, {"--clip", "--dynamics", "--attached", "--controls", "--joint-map", "--state-in", "--state-out"});
      if (!is_left_out) options.push_back(argument);
    } else if (!is_left_out && !options.empty()) {
      options.back() += '\0' + (is_clip ? clip_within(argument) : is_input ? std::string() : argument);
    }
  }
  std::ranges::sort(options);
  ContentHash hash;
  for (const std::string& option : options) hash.add(option);
  return hash.value();
}

fs::path done_beside(const fs::path& output) { return fs::path(output) += ".done.json"; }
fs::path failed_beside(const fs::path& output) { return fs::path(output) += ".failed.json"; }

Json to_json(const TaskKey& key) {
  return {{"version", key.version}, {"options", hexadecimal(key.options)}, {"inputs", stamps(key.inputs)}};
}

TaskKey task_key(const JsonObject& object, const fs::path& path) {
  object.allow({"version", "options", "inputs"});
  return {object.name("version"), object.hash("options"), read_stamps(object, "inputs", path)};
}

void write_record(const TaskRecord& record) {
  write_json({{"schema", kDoneSchema},
              {"made_of", to_json(record.key)},
              {"outputs", stamps(record.outputs)},
              {"summary", record.summary}},
             done_beside(record.outputs.front().path));
}

std::optional<TaskRecord> read_record(const fs::path& output) {
  const fs::path path = done_beside(output);
  try {
    const JsonFile top(path, kDoneSchema, "the top level", {"schema", "made_of", "outputs", "summary"});
    TaskRecord record;
    record.key = made_of(top);
    record.outputs = read_stamps(top, "outputs", path);
    record.summary = top.json().value("summary", Json());
    if (record.outputs.empty()) return std::nullopt;
    // A folder that was moved with all that is in it: the outputs lie beside the record.
    for (FileStamp& file : record.outputs) file.path = path.parent_path() / fs::path(file.path).filename();
    return record;
  } catch (const Error&) {
    return std::nullopt;
  }
}

void write_failure(const TaskFailure& failure, const fs::path& output) {
  try {
    write_json({{"schema", kFailedSchema},
                {"made_of", to_json(failure.key)},
                {"exit_code", failure.exit_code},
                {"message", Json::parse(Json(failure.message).dump(-1, ' ', false, Json::error_handler_t::replace))},
                {"host", failure.host}},
               failed_beside(output));
  } catch (const Error&) {  // the disk is full, most likely, which is what has failed
  }
}

std::optional<TaskFailure> read_failure(const fs::path& output) {
  const fs::path path = failed_beside(output);
  try {
    const JsonFile top(path, kFailedSchema, "the top level", {"schema", "made_of", "exit_code", "message", "host"});
    return TaskFailure{made_of(top), top.integer("exit_code", 1, 255), top.text("message"), top.text("host")};
  } catch (const Error&) {
    return std::nullopt;
  }
}

void remove_failure(const fs::path& output) {
  std::error_code ignored;
  fs::remove(failed_beside(output), ignored);
}

bool is_current(const TaskKey& key, const std::string& version, std::uint64_t options, bool read_all) {
  return key.version == version && key.options == options &&
         std::ranges::all_of(key.inputs, [&](const FileStamp& file) { return is_unchanged(file, read_all); });
}

bool is_whole(const TaskRecord& record, bool read_all) {
  return std::ranges::all_of(record.outputs, [&](const FileStamp& file) { return is_unchanged(file, read_all); });
}

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

}  // namespace bodyopt::farm
