#include "trainer/dataset/json_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "runtime/basis/atomic_file.h"
#include "runtime/basis/error.h"

namespace bodyopt {

Json read_json(const std::filesystem::path& path, const std::string& schema) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!std::filesystem::is_regular_file(path) || !file || !(text << file.rdbuf())) {
    throw Error(ErrorKind::file, path.string() + ": cannot be read: no such file?");
  }
  Json json = Json::parse(text.str(), nullptr, false);
  if (json.is_discarded()) {
    throw Error(ErrorKind::file, path.string() + ": expected JSON; the text is damaged or cut off");
  }
  if (!json.is_object() || !json.contains("schema") || !json["schema"].is_string()) {
    throw Error(ErrorKind::file, path.string() + ": expected an object with \"schema\": \"" + schema +
                                     "\"; it is JSON of something else");
  }
  if (json["schema"] != schema) {
    throw Error(ErrorKind::file, path.string() + ": its schema is '" + json["schema"].get<std::string>() +
                                     "', expected '" + schema + "': another kind of file, or another version");
  }
  return json;
}

void write_json(const Json& json, const std::filesystem::path& path) {
  const std::string text = json.dump(2) + "\n";
  write_file_atomically(path, std::as_bytes(std::span(text)));
}

JsonObject::JsonObject(const Json& object, const std::filesystem::path& path, std::string place)
    : object_(object), path_(path), place_(std::move(place)) {
  if (!object_.is_object()) refuse("is not an object");
}

void JsonObject::allow(std::initializer_list<const char*> keys) const {
  for (const auto& [key, value] : object_.items()) {
    if (std::none_of(keys.begin(), keys.end(), [&k = key](const char* known) { return k == known; })) {
      refuse("has the unknown key '" + key + "': misspelt?");
    }
  }
}

std::string JsonObject::text(const char* key) const {
  const Json& value = at(key);
  if (!value.is_string()) refuse(std::string("'") + key + "' is not a string");
  return value.get<std::string>();
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

int JsonObject::integer(const char* key, double low, double high) const {
  const double value = number(key, low, high);
  if (value != std::floor(value)) refuse(std::string("'") + key + "' is not a whole number");
  return static_cast<int>(value);
}

bool JsonObject::boolean(const char* key) const {
  const Json& value = at(key);
  if (!value.is_boolean()) refuse(std::string("'") + key + "' is neither true nor false");
  return value.get<bool>();
}

const Json& JsonObject::array(const char* key) const {
  const Json& value = at(key);
  if (!value.is_array()) refuse(std::string("'") + key + "' is not a list");
  return value;
}

void JsonObject::refuse(const std::string& what) const {
  throw Error(ErrorKind::file, path_.string() + ": " + place_ + " " + what);
}

const Json& JsonObject::at(const char* key) const {
  const auto found = object_.find(key);
  if (found == object_.end()) refuse(std::string("lacks '") + key + "'");
  return *found;
}

}  // namespace bodyopt
