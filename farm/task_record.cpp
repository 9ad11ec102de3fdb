#include "farm/task_record.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

#include "assets/json_file.h"
#include "base/content_hash.h"
#include "runtime/core/error.h"
#include "runtime/core/hexadecimal.h"
#include "runtime/core/transformed.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

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

namespace fs = std::filesystem;

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

}  // namespace

FileStamp stamp_file(const fs::path& path) {
  const FileTimes times = times_of(path);
  if (!times.is_file) fail(path, fs::exists(path) ? "it is no file" : "it is not there");
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
    const Json json = read_json(path, kDoneSchema);
    const JsonObject top(json, path, "the top level");
    top.allow({"schema", "made_of", "outputs", "summary"});
    TaskRecord record;
    record.key = task_key(JsonObject(json.value("made_of", Json()), path, "made_of"), path);
    record.outputs = read_stamps(top, "outputs", path);
    record.summary = json.value("summary", Json());
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
    const Json json = read_json(path, kFailedSchema);
    const JsonObject top(json, path, "the top level");
    top.allow({"schema", "made_of", "exit_code", "message", "host"});
    return TaskFailure{task_key(JsonObject(json.value("made_of", Json()), path, "made_of"), path),
                       top.integer("exit_code", 1, 255), top.text("message"), top.text("host")};
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

}  // namespace bodyopt
