// JSON files: read and checked key by key, written whole or not at all.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/core/error.h"
#include "runtime/core/json.h"

namespace bodyopt {

// Parses a file whose top level is an object with "schema": `schema`. Throws Error(file).
Json read_json(const std::filesystem::path& path, const std::string& schema);
// Parses a file's text that is in memory already; messages call it `path`.
Json parse_json(std::string_view text, const std::filesystem::path& path, const std::string& schema);
// Throws Error(file); Error(usage) over a file of another kind (see refuse_other_kind()).
void write_json(const Json& json, const std::filesystem::path& path);
// Throws Error(file) where a file of that name is there that is no object with this value of `key`: `what` would take
// its place.
void require_replaceable_json(const std::filesystem::path& path, const char* key, const std::string& value,
                              const std::string& what);
// The text that write_json() would write. Throws Error(file), too.
std::string text_of(const Json& json, const std::filesystem::path& path);

// One object of a JSON file, read strictly: every access that fails throws Error(file) naming the file and the key.
class JsonObject {
 public:
  // `place` is how messages call the object, e.g. "takes[2]".
  JsonObject(const Json& object, const std::filesystem::path& path, std::string place);

  // Refuses keys that are not in the list: most likely they are misspelt.
  void allow(std::initializer_list<const char*> keys) const;
  std::string text(const char* key) const;
  std::string name(const char* key) const;  // text that is not empty
  double number(const char* key, double low, double high) const;
  int integer(const char* key, double low = -1e9, double high = 1e9) const;
  bool boolean(const char* key) const;
  std::uint64_t hash(const char* key) const;  // 16 hexadecimal digits
  const Json& array(const char* key) const;
  std::vector<std::string> names(const char* key) const;   // of a list of texts
  std::vector<JsonObject> objects(const char* key) const;  // of a list, by the names "key[0]", "key[1]" ...
  bool is_null(const char* key) const;
  const Json& json() const { return object_; }
  const std::filesystem::path& path() const { return path_; }
  const std::string& place() const { return place_; }
  bool has(const char* key) const;
  // The message goes on with these parts.
  [[noreturn]] void refuse(const auto&... what) const {
    throw Error(ErrorKind::file, path_, ": ", place_, " ", what...);
  }

 private:
  const Json& at(const char* key) const;
  const Json& object_;
  const std::filesystem::path& path_;
  std::string place_;
};

struct JsonContent {
  std::shared_ptr<const Json> content;
};

// The top level of a file, which has no other keys than these. Throws as read_json() and JsonObject do.
class JsonFile : JsonContent, public JsonObject {
 public:
  JsonFile(const std::filesystem::path& path, const std::string& schema, std::string place,
           std::initializer_list<const char*> keys);
};

}  // namespace bodyopt
