// Converts plain structs to and from JSON objects; their fields are listed once. A generic function `fields(list,
// structure)` names every field to a `list`: a FieldReader or a FieldWriter. A FieldWriter takes limits, to be called
// alike, and ignores them.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/json_file.h"
#include "runtime/core/text.h"
#include "runtime/core/transform.h"

namespace bodyopt {

// Reads the fields that the object has, and leaves the others alone; a field may be an optional of what it is. Throws
// Error(file), naming file and key, with what was found and what was expected; finish() for keys that are no fields.
class FieldReader : private JsonObject {
 public:
  // `place`: how messages call the object.
  FieldReader(const Json& json, const std::filesystem::path& path, const std::string& place)
      : JsonObject(json, path, place) {}

  // See FieldWriter.
  static bool wants(bool /*says_something*/) { return true; }

  void boolean(const char* key, bool& value) {
    if (is_there(key)) value = JsonObject::boolean(key);
  }

  void number(const char* key, auto& value, double low, double high) {
    if (is_there(key)) value = JsonObject::number(key, low, high);
  }

  void integer(const char* key, auto& value, double low, double high) {
    if (is_there(key)) value = JsonObject::integer(key, low, high);
  }

  // Not empty, where it is there.
  void text(const char* key, std::string& value) {
    if (is_there(key)) value = name(key);
  }

  void vector(const char* key, auto& value, double low, double high) {
    if (is_there(key)) value = three_numbers(key, low, high);
  }

  // One of the names, in the order of the enumeration.
  template <typename Choice, std::size_t N>
  void choice(const char* key, Choice& value, const std::array<const char*, N>& names) {
    if (is_there(key)) value = static_cast<Choice>(place_among(key, names));
  }

  // A structure, and what names its fields.
  template <typename Structure, typename Fields>
  void structure(const char* key, Structure& value, const Fields& fields) {
    if (!is_there(key)) return;
    FieldReader inner = object(key);
    fields(inner, value);
    inner.finish();
  }

  // A list of structures.
  template <typename Structure, typename Fields>
  void structures(const char* key, std::vector<Structure>& values, const Fields& fields) {
    if (!is_there(key)) return;
    for (const Json& item : list(key)) {
      FieldReader inner(item, path(), place() + " '" + key + "[" + std::to_string(values.size()) + "]'");
      fields(inner, values.emplace_back());
      inner.finish();
    }
  }

  // An object with any names; `field(list, name, value)` is called for each value.
  template <typename Value, typename Field>
  void named(const char* key, std::map<std::string, Value>& values, const Field& field) {
    if (!is_there(key)) return;
    FieldReader inner = object(key);
    for (const auto& [name, item] : inner.json().items()) field(inner, name.c_str(), values[name]);
  }

  // Like named(), for values by their frames.
  template <typename Value, typename Field>
  void by_frame(const char* key, std::map<int, Value>& values, const Field& field) {
    std::map<std::string, Value> by_name;
    named(key, by_name, field);
    for (auto& [name, value] : by_name) {
      const std::optional<int> frame = number_in<int>(name);
      if (!frame) refuse("'", key, "' has '", name, "', expected the number of a frame");
      values[*frame] = std::move(value);
    }
  }

  void finish() const;

 private:
  bool is_there(const char* key) {
    known_.emplace_back(key);
    return has(key);
  }
  Vec3 three_numbers(const char* key, double low, double high) const;
  std::size_t place_among(const char* key, std::span<const char* const> names) const;
  const Json& list(const char* key) const;
  FieldReader object(const char* key) const;
  [[noreturn]] void refuse_value(const char* key, const std::string& expected) const;

  std::vector<std::string> known_;
};

class FieldWriter {
 public:
  // Of a field that earlier programs refuse: a file has it only where it says something.
  static bool wants(bool says_something) { return says_something; }

  void boolean(const char* key, bool value) { json_[key] = value; }
  void number(const char* key, const auto& value, double, double) { put(key, value); }
  void integer(const char* key, const auto& value, double, double) { put(key, value); }
  void vector(const char* key, const auto& value, double, double) { put(key, value); }
  void text(const char* key, const std::string& value) {
    if (!value.empty()) json_[key] = value;
  }

  template <typename Choice, std::size_t N>
  void choice(const char* key, Choice value, const std::array<const char*, N>& names) {
    json_[key] = names[static_cast<std::size_t>(value)];
  }

  template <typename Structure, typename Fields>
  void structure(const char* key, const Structure& value, const Fields& fields) {
    FieldWriter inner;
    fields(inner, value);
    json_[key] = inner.json();
  }

  template <typename Structure, typename Fields>
  void structures(const char* key, const std::vector<Structure>& values, const Fields& fields) {
    json_[key] = Json::array();
    for (const Structure& value : values) {
      FieldWriter inner;
      fields(inner, value);
      json_[key].push_back(inner.json());
    }
  }

  template <typename Value, typename Field>
  void named(const char* key, const std::map<std::string, Value>& values, const Field& field) {
    FieldWriter inner;
    for (const auto& [name, value] : values) field(inner, name.c_str(), value);
    json_[key] = inner.json();
  }

  template <typename Value, typename Field>
  void by_frame(const char* key, const std::map<int, Value>& values, const Field& field) {
    std::map<std::string, Value> by_name;
    for (const auto& [frame, value] : values) by_name[std::to_string(frame)] = value;
    named(key, by_name, field);
  }

  const Json& json() const { return json_; }

 private:
  template <typename Value>
  void put(const char* key, const Value& value) {
    json_[key] = value;
  }
  template <typename Value>
  void put(const char* key, const std::optional<Value>& value) {
    if (value) json_[key] = *value;
  }

  Json json_ = Json::object();
};

}  // namespace bodyopt
