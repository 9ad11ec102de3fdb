// One piece of work that is done once: skipped where it is done, taken up where it was interrupted, and recorded.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "farm/plan.h"
#include "runtime/core/error.h"
#include "runtime/core/json.h"

namespace bodyopt {
class JsonObject;
}

namespace bodyopt::farm {

// Beside an output lies how it came about: FILE.done.json, or why it did not: FILE.failed.json. These files alone tell
// what was done, on whatever machine it was.

// The state of a file when it was read or written, to know later whether it has changed.
struct FileStamp {
  std::string path;
  std::uint64_t bytes = 0;
  std::int64_t modified = 0;  // nanoseconds; only ever compared for equality: clocks differ, and go back
  std::uint64_t hash = 0;     // of the content
};

// Reads the whole file. Throws Error(file).
FileStamp stamp_file(const std::filesystem::path& path);

// True where the file has the content it was stamped with. A file of the same size is read where its time of change is
// another, or with `read_all`: rotten content has the old time.
bool is_unchanged(const FileStamp& stamp, bool read_all);

Json to_json(const FileStamp& stamp);
FileStamp file_stamp(const JsonObject& object);

// All that decides the bytes of an output, but for the device.
struct TaskKey {
  std::string version;        // of the program
  std::uint64_t options = 0;  // see task_options()
  std::vector<FileStamp> inputs;
};

struct TaskRecord {
  TaskKey key;
  std::vector<FileStamp> outputs;  // the one beside which this lies is the first
  Json summary;                    // for people and reports: device, seconds, what was flagged
};

struct TaskFailure {
  TaskKey key;
  int exit_code = 0;
  std::string message, host;
};

// A hash of the options of a command line, whatever their order. Files of inputs and of --state-out count as given or
// not, for content identifies inputs. Not counted are --out, --json, --progress, --resume and --pretend.
std::uint64_t task_options(const std::vector<std::string>& arguments);

std::filesystem::path done_beside(const std::filesystem::path& output);
std::filesystem::path failed_beside(const std::filesystem::path& output);

// Throws Error(file).
void write_record(const TaskRecord& record);
// Nothing where there is none, or one that cannot be read: the work is to be done again.
std::optional<TaskRecord> read_record(const std::filesystem::path& output);

// Writes it if that is possible: a failure to write is not reported.
void write_failure(const TaskFailure& failure, const std::filesystem::path& output);
std::optional<TaskFailure> read_failure(const std::filesystem::path& output);
void remove_failure(const std::filesystem::path& output);

// True where the version, the options and the content of every input are those of the key.
bool is_current(const TaskKey& key, const std::string& version, std::uint64_t options, bool read_all);
// True where every output is as it was written.
bool is_whole(const TaskRecord& record, bool read_all);

Json to_json(const TaskKey& key);
TaskKey task_key(const JsonObject& object, const std::filesystem::path& path);

// Work of an interrupted run, in the folder FILE.checkpoint.
struct Checkpoint {
  std::size_t frames = 0;  // that are done
  Json log;                // what is known of them
};

class TaskRun {
 public:
  // Reads the inputs. Throws Error(file).
  TaskRun(std::filesystem::path output, const std::string& version, const std::vector<std::string>& arguments,
          const std::vector<std::filesystem::path>& inputs);

  // The record of the same work on the same inputs, where its outputs are what they were. `outputs` must be among them.
  std::optional<TaskRecord> done(const std::vector<std::filesystem::path>& outputs) const;
  // Throws Error(interrupted) where an input is another than when this began: what was made of it is of neither.
  void require_same_inputs() const;
  void finish(const std::vector<std::filesystem::path>& outputs, const Json& summary) const;
  // Says beside the output why there is none. Interruptions write nothing.
  void fail(const Error& error) const;

  std::filesystem::path checkpoint_folder() const;
  // `files`: in that folder, written already; all that taking up needs.
  void write_checkpoint(const Checkpoint& checkpoint, const std::vector<std::filesystem::path>& files) const;
  // Nothing where there is none of this work and these inputs, or where one of its files is damaged.
  std::optional<Checkpoint> read_checkpoint() const;
  void remove_checkpoint() const;

 private:
  std::filesystem::path output_;
  TaskKey key_;
};

// The state of a show: a line per element, and the frames of it that are worth a look. It is made of what lies beside
// the outputs alone.

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

// States of every step of every task, in their order; files are looked at side by side.
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

// `most`: frames worth a look at most. The plan must outlive the result. Unreadable parts of a record are left out.
ShowSummary summarize_show(const FarmPlan& plan, const std::vector<std::vector<StepStatus>>& statuses,
                           std::size_t most);

}  // namespace bodyopt::farm
