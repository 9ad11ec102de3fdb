// What a file was when it was read or written, to know later whether it still is.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "runtime/core/json.h"

namespace bodyopt {

class JsonObject;

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

}  // namespace bodyopt
