#include "base/json_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "runtime/basis/file_schema.h"
#include "runtime/basis/read_file.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/file_kind.h"
#include "runtime/core/json.h"

namespace bodyopt {

namespace {

constexpr std::uint64_t kLargestFile = 64 << 20;  // bytes; parsed JSON takes many times its text in memory

}  // namespace

Json read_json(const std::filesystem::path& path, const std::string& schema) {
  const std::string content = read_file(path, kLargestFile, "a file of ours");
  const std::string kind = looks_like(path);
  if (!kind.empty() && !content.starts_with('{')) throw Error(ErrorKind::file, path, ": expected JSON", kind);
  return parse_json(content, path, schema);
}

Json parse_json(std::string_view text, const std::filesystem::path& path, const std::string& schema) {
  Json json = parse_strict_json(text, path.string());
  if (!json.is_object() || !json.contains("schema") || !json["schema"].is_string()) {
    throw Error(ErrorKind::file, path, ": expected an object with \"schema\": \"", schema,
                "\"; it is JSON of something else");
  }
  if (json["schema"] != schema) {
    throw Error(ErrorKind::file, path, ": its schema is '", json["schema"].get<std::string>(), "', expected '", schema,
                "': another kind of file, or another version");
  }
  return json;
}

std::string text_of(const Json& json, const std::filesystem::path& path) {
  return strict_json_text(json, path.string(), 2) + "\n";
}

void write_json(const Json& json, const std::filesystem::path& path) {
  refuse_other_kind(path, json.is_object() ? json.value("schema", "") : "");
  write_file_atomically(path, text_of(json, path));
}

void require_replaceable_json(const std::filesystem::path& path, const char* key, const std::string& value,
                              const std::string& what) {
  if (!std::filesystem::is_regular_file(path)) return;
  try {
    const Json there = parse_strict_json(read_file(path, kLargestFile, what), path.string());
    if (there.is_object() && there.contains(key) && there[key] == value) return;
  } catch (const Error&) {  // as little what would be written as any other file
  }
  throw Error(ErrorKind::file, path, ": is there already, and ", what, " would take its place: expected one, with \"",
              key, "\": \"", value, "\"", looks_like(path), ": give another name, or remove it");
}

JsonObject::JsonObject(const Json& object, const std::filesystem::path& path, std::string place)
    : object_(object), path_(path), place_(std::move(place)) {
  if (!object_.is_object()) refuse("is not an object");
}

void JsonObject::allow(std::initializer_list<const char*> keys) const {
  for (const auto& [key, value] : object_.items()) {
    if (std::ranges::none_of(keys, [&k = key](const char* known) { return k == known; })) {
      refuse("has the unknown key '", key, "': misspelt?");
    }
  }
}

std::string JsonObject::text(const char* key) const {
  const Json& value = at(key);
  if (!value.is_string()) refuse("'", key, "' is not text");
  return value.get<std::string>();
}

std::string JsonObject::name(const char* key) const {
  const std::string value = text(key);
  if (value.empty()) refuse("'", key, "' is empty");
  return value;
}

double JsonObject::number(const char* key, double low, double high) const {
  const Json& value = at(key);
  const double number = value.is_number() ? value.get<double>() : std::nan("");
  if (!(number >= low && number <= high)) {
    std::ostringstream message;
    message << "'" << key << "' is " << value.dump() << ", expected a number from " << low << " to " << high;
    refuse(message.str());
  }
  return number;
}

bool JsonObject::is_null(const char* key) const { return at(key).is_null(); }

int JsonObject::integer(const char* key, double low, double high) const {
  const double value = number(key, low, high);
  if (value != std::floor(value)) refuse("'", key, "' is ", at(key).dump(), ", expected a whole number");
  return static_cast<int>(value);
}

bool JsonObject::boolean(const char* key) const {
  const Json& value = at(key);
  if (!value.is_boolean()) refuse("'", key, "' is ", value.dump(), ", expected true or false");
  return value.get<bool>();
}

std::uint64_t JsonObject::hash(const char* key) const {
  const std::string digits = text(key);
  std::uint64_t value = 0;
  const char* end = digits.data() + digits.size();
  const auto [stop, failure] = std::from_chars(digits.data(), end, value, 16);
  if (digits.size() != 16 || failure != std::errc() || stop != end) refuse("'", key, "' is not 16 hexadecimal digits");
  return value;
}

const Json& JsonObject::array(const char* key) const {
  const Json& value = at(key);
  if (!value.is_array()) refuse("'", key, "' is not a list");
  return value;
}

std::vector<std::string> JsonObject::names(const char* key) const {
  std::vector<std::string> names;
  for (const Json& name : array(key)) {
    if (!name.is_string()) refuse(std::string("'") + key + "' is not a list of names");
    names.push_back(name.get<std::string>());
  }
  return names;
}

std::vector<JsonObject> JsonObject::objects(const char* key) const {
  std::vector<JsonObject> objects;
  for (const Json& item : array(key)) {
    objects.emplace_back(item, path_, key + ("[" + std::to_string(objects.size()) + "]"));
  }
  return objects;
}

bool JsonObject::has(const char* key) const { return object_.contains(key); }

const Json& JsonObject::at(const char* key) const {
  const auto found = object_.find(key);
  if (found == object_.end()) refuse("lacks '", key, "'");
  return *found;
}

JsonFile::JsonFile(const std::filesystem::path& path, const std::string& schema, std::string place,
                   std::initializer_list<const char*> keys)
    : JsonContent{std::make_shared<const Json>(read_json(path, schema))}, JsonObject(*content, path, std::move(place)) {
  allow(keys);
}

}  // namespace bodyopt
