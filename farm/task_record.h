// What lies beside an output and says how it came about: FILE.done.json, or why it did not: FILE.failed.json. What was
// done is known by these alone, on whatever machine it was.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "runtime/core/json.h"

namespace bodyopt {

class JsonObject;

// What a file was when it was read or written, to know later whether it still is.
struct FileStamp {
  std::string path;
  std::uint64_t bytes = 0;
  std::int64_t modified = 0;  // nanoseconds; only ever compared for equality: clocks differ, and go back
  std::uint64_t hash = 0;     // of the content
};

// Reads the whole file. Throws Error(file).
FileStamp stamp_file(const std::filesystem::path& path);

// True where the file has the content it was stamped with. It is read only where its size is the same and its time of
// change is another, or where `read_all` asks for it: content that has rotted has the old time.
bool is_unchanged(const FileStamp& stamp, bool read_all);

Json to_json(const FileStamp& stamp);
FileStamp file_stamp(const JsonObject& object);

// What decides the bytes of an output, but for the device.
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

// A hash of the options of a command line: of those that name an input only that they are there, for inputs are known
// by their content; none of those that name outputs or say how to run. The order of the options does not matter.
std::uint64_t task_options(const std::vector<std::string>& arguments);

std::filesystem::path done_beside(const std::filesystem::path& output);
std::filesystem::path failed_beside(const std::filesystem::path& output);

// Throws Error(file).
void write_record(const TaskRecord& record);
// Nothing where there is none, or one that cannot be read: the work is to be done again.
std::optional<TaskRecord> read_record(const std::filesystem::path& output);

// As far as possible: where nothing can be written, nobody is told.
void write_failure(const TaskFailure& failure, const std::filesystem::path& output);
std::optional<TaskFailure> read_failure(const std::filesystem::path& output);
void remove_failure(const std::filesystem::path& output);

// True where the version, the options and the content of every input are those of the key.
bool is_current(const TaskKey& key, const std::string& version, std::uint64_t options, bool read_all);
// True where every output is as it was written.
bool is_whole(const TaskRecord& record, bool read_all);

Json to_json(const TaskKey& key);
TaskKey task_key(const JsonObject& object, const std::filesystem::path& path);

}  // namespace bodyopt
