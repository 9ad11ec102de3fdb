#include "farm/task_run.h"

#include <unistd.h>

#include <algorithm>
#include <utility>

#include "assets/json_file.h"
#include "runtime/core/transformed.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

constexpr char kCheckpointSchema[] = "bodyopt-checkpoint-1";

bool is_same(const TaskKey& a, const TaskKey& b) {
  return a.version == b.version && a.options == b.options &&
         std::equal(a.inputs.begin(), a.inputs.end(), b.inputs.begin(), b.inputs.end(),
                    [](const FileStamp& x, const FileStamp& y) { return x.hash == y.hash && x.bytes == y.bytes; });
}

fs::path checkpoint_file(const fs::path& folder) { return folder / "checkpoint.json"; }

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
    const Json json = read_json(path, kCheckpointSchema);
    const JsonObject top(json, path, "the top level");
    top.allow({"schema", "made_of", "frames", "files", "log"});
    if (!is_same(task_key(JsonObject(json.value("made_of", Json()), path, "made_of"), path), key_)) return std::nullopt;
    for (const Json& file : top.array("files")) {
      if (!is_unchanged(file_stamp(JsonObject(file, path, "files")), true)) return std::nullopt;
    }
    return Checkpoint{static_cast<std::size_t>(top.integer("frames", 1)), json.value("log", Json())};
  } catch (const Error&) {
    return std::nullopt;
  }
}

void TaskRun::remove_checkpoint() const {
  std::error_code ignored;
  fs::remove_all(checkpoint_folder(), ignored);
}

}  // namespace bodyopt
