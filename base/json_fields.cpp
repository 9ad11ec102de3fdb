#include "base/json_fields.h"

#include <algorithm>

#include "base/wording.h"

namespace bodyopt {

Vec3 FieldReader::three_numbers(const char* key, double low, double high) const {
  const Json& list = json()[key];
  Vec3 value{};
  bool good = list.is_array() && list.size() == value.size();
  for (std::size_t i = 0; good && i < value.size(); ++i) {
    good = list[i].is_number() && list[i].get<double>() >= low && list[i].get<double>() <= high;
    if (good) value[i] = list[i].get<double>();
  }
  if (!good) refuse_value(key, "three numbers from " + Json(low).dump() + " to " + Json(high).dump());
  return value;
}

std::size_t FieldReader::place_among(const char* key, std::span<const char* const> names) const {
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (json()[key] == names[k]) return k;
  }
  const std::vector<std::string> all(names.begin(), names.end());
  refuse_value(key, "one of " + list_names(all, all.size()));
}

const Json& FieldReader::list(const char* key) const {
  if (!json()[key].is_array()) refuse_value(key, "a list");
  return json()[key];
}

FieldReader FieldReader::object(const char* key) const {
  if (!json()[key].is_object()) refuse_value(key, "an object");
  return {json()[key], path(), place() + " '" + key + "'"};
}

void FieldReader::finish() const {
  for (const auto& [key, value] : json().items()) {
    if (std::ranges::find(known_, key) != known_.end()) continue;
    refuse("has the unknown key '", key, "': misspelt (the nearest are ", list_names(nearest_names(known_, key)),
           "), or of a newer version?");
  }
}

void FieldReader::refuse_value(const char* key, const std::string& expected) const {
  refuse("'", key, "' is ", json()[key].dump(), ", expected ", expected);
}

}  // namespace bodyopt
