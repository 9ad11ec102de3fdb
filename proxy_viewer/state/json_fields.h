// Plain structs to and from JSON objects, their fields listed once: a generic function `fields(list, structure)` names
// every field to a `list`, which is a FieldReader or a FieldWriter. (FieldWriter takes limits, to be called alike, and
// ignores them.)
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "assets/json_file.h"
#include "assets/wording.h"
#include "runtime/core/transform.h"

namespace bodyopt {

// Reads the fields that the object has, and leaves the others alone. Throws Error(file), naming file and key, with what
// was found and what was expected; finish() for keys that are no fields.
class FieldReader {
 public:
  // `place`: how messages call the object.
  FieldReader(const Json& json, const std::filesystem::path& path, const std::string& place)
      : json_(json), path_(path), place_(place), object_(json, path, place) {}

  void boolean(const char* key, bool& value) {
    if (has(key)) value = object_.boolean(key);
  }

  void number(const char* key, double& value, double low, double high) {
    if (has(key)) value = object_.number(key, low, high);
  }

  void number(const char* key, std::optional<double>& value, double low, double high) {
    if (has(key)) value = object_.number(key, low, high);
  }

  void integer(const char* key, int& value, double low, double high) {
    if (has(key)) value = object_.integer(key, low, high);
  }

  void integer(const char* key, std::optional<int>& value, double low, double high) {
    if (has(key)) value = object_.integer(key, low, high);
  }

  // Not empty, where it is there.
  void text(const char* key, std::string& value) {
    if (has(key)) value = object_.name(key);
  }

  void vector(const char* key, Vec3& value, double low, double high) {
    if (!has(key)) return;
    const Json& list = json_[key];
    bool good = list.is_array() && list.size() == value.size();
    for (std::size_t i = 0; good && i < value.size(); ++i) {
      good = list[i].is_number() && list[i].get<double>() >= low && list[i].get<double>() <= high;
    }
    if (!good) refuse(key, "three numbers from " + Json(low).dump() + " to " + Json(high).dump());
    for (std::size_t i = 0; i < value.size(); ++i) value[i] = list[i].get<double>();
  }

  void vector(const char* key, std::optional<Vec3>& value, double low, double high) {
    if (has(key)) vector(key, value.emplace(), low, high);
  }

  // One of the names, in the order of the enumeration.
  template <typename Choice, std::size_t N>
  void choice(const char* key, Choice& value, const std::array<const char*, N>& names) {
    if (!has(key)) return;
    std::string all;
    for (std::size_t k = 0; k < N; ++k) {
      if (json_[key] == names[k]) {
        value = static_cast<Choice>(k);
        return;
      }
      all += (k == 0 ? "'" : ", '") + std::string(names[k]) + "'";
    }
    refuse(key, "one of " + all);
  }

  // A structure, and what names its fields.
  template <typename Structure, typename Fields>
  void structure(const char* key, Structure& value, const Fields& fields) {
    if (!has(key)) return;
    FieldReader inner = object(key);
    fields(inner, value);
    inner.finish();
  }

  // A list of structures.
  template <typename Structure, typename Fields>
  void structures(const char* key, std::vector<Structure>& values, const Fields& fields) {
    if (!has(key)) return;
    if (!json_[key].is_array()) refuse(key, "a list");
    for (const Json& item : json_[key]) {
      FieldReader inner(item, path_, place_ + " '" + key + "[" + std::to_string(values.size()) + "]'");
      fields(inner, values.emplace_back());
      inner.finish();
    }
  }

  // An object with any names; `field(list, name, value)` is called for each value.
  template <typename Value, typename Field>
  void named(const char* key, std::map<std::string, Value>& values, const Field& field) {
    if (!has(key)) return;
    FieldReader inner = object(key);
    for (const auto& [name, item] : inner.json_.items()) field(inner, name.c_str(), values[name]);
  }

  // As named(), of values by their frames.
  template <typename Value, typename Field>
  void by_frame(const char* key, std::map<int, Value>& values, const Field& field) {
    std::map<std::string, Value> by_name;
    named(key, by_name, field);
    for (auto& [name, value] : by_name) {
      int frame = 0;
      const auto [end, problem] = std::from_chars(name.data(), name.data() + name.size(), frame);
      if (problem != std::errc{} || end != name.data() + name.size()) {
        object_.refuse("'" + std::string(key) + "' has '" + name + "', expected the number of a frame");
      }
      values[frame] = std::move(value);
    }
  }

  void finish() const {
    for (const auto& [key, value] : json_.items()) {
      if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
        object_.refuse("has the unknown key '" + key + "': misspelt (the nearest are " +
                       list_names(nearest_names(known_, key)) + "), or of a newer version?");
      }
    }
  }

 private:
  bool has(const char* key) {
    known_.emplace_back(key);
    return json_.contains(key);
  }

  FieldReader object(const char* key) const {
    if (!json_[key].is_object()) refuse(key, "an object");
    return {json_[key], path_, place_ + " '" + key + "'"};
  }

  [[noreturn]] void refuse(const char* key, const std::string& expected) const {
    object_.refuse("'" + std::string(key) + "' is " + json_[key].dump() + ", expected " + expected);
  }

  const Json& json_;
  const std::filesystem::path& path_;
  std::string place_;
  JsonObject object_;
  std::vector<std::string> known_;
};

class FieldWriter {
 public:
  void boolean(const char* key, bool value) { json_[key] = value; }
  void number(const char* key, double value, double, double) { json_[key] = value; }
  void number(const char* key, const std::optional<double>& value, double, double) {
    if (value) json_[key] = *value;
  }
  void integer(const char* key, int value, double, double) { json_[key] = value; }
  void integer(const char* key, const std::optional<int>& value, double, double) {
    if (value) json_[key] = *value;
  }
  void text(const char* key, const std::string& value) {
    if (!value.empty()) json_[key] = value;
  }
  void vector(const char* key, const Vec3& value, double, double) { json_[key] = value; }
  void vector(const char* key, const std::optional<Vec3>& value, double, double) {
    if (value) json_[key] = *value;
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
  Json json_ = Json::object();
};

}  // namespace bodyopt
