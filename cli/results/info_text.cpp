#include "cli/results/info_text.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "assets/json_file.h"
#include "cli/results/level_table.h"

namespace bodyopt::cli {
namespace {

constexpr std::size_t kLong = 8, kMostShown = 64;  // entries: of what is within an entry; of a list

bool is_list_of_objects(const Json& value) {
  return value.is_array() && !value.empty() && std::ranges::all_of(value, [](const Json& v) { return v.is_object(); });
}

std::string text_of(const Json& value);

// Counted, where it is long.
std::string text_within(const Json& value) {
  if (!value.is_structured() || (value.size() <= kLong && !is_list_of_objects(value))) return text_of(value);
  return format("{} (--json names them)", value.size());
}

// "vertices 12, name shirt"; "Hips, Spine".
std::string text_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return format("{:.5g}", value.get<double>());
  if (!value.is_structured()) return value.dump();
  if (value.empty()) return "none";
  std::string text;
  std::size_t shown = 0;
  for (const auto& [key, item] : value.items()) {
    if (shown == kMostShown) return text + format(", and {} more", value.size() - shown);
    text += (shown++ > 0 ? ", " : "") + (value.is_object() ? key + " " : "") + text_within(item);
  }
  return text;
}

// Objects in a list have lines of their own.
std::string line(const std::string& key, const Json& value) {
  if (!is_list_of_objects(value)) return format("{:18} {}\n", key, text_of(value));
  std::string text;
  for (std::size_t k = 0; k < value.size(); ++k) {
    text += format("{:18} {}\n", k == 0 ? key : "", text_of(value[k]));
  }
  return text;
}

// Some of it is JSON in a string.
std::string metadata_lines(const Json& metadata) {
  std::string text;
  for (const auto& [key, value] : metadata.items()) {
    const Json told = value.is_string() ? Json::parse(value.get<std::string>(), nullptr, false) : value;
    text += line(key, told.is_object() ? told : value);
  }
  return text;
}

// The bases that a training could give, a line each.
std::string curve_table(const Json& curve, bool of_levels) {
  std::string text = format("\nwhat training{} could give:\n{:>16} {:>16} {:>12} {:>14}\n", of_levels ? " level 0" : "",
                            "bytes per vertex", "expected RMS, mm", "coefficients", "estimated us");
  for (const Json& point : curve) {
    text += format("{:16.0f} {:16.3f} {:12} {:14.0f}\n", point.at("bytes_per_vertex").get<double>(),
                   point.at("expected_rms_mm").get<double>(), point.at("coefficients").get<unsigned>(),
                   point.at("microseconds").get<double>());
  }
  return text + "estimated us: of a frame on one core, by the sizes of the tables; nothing is measured for it\n";
}

}  // namespace

std::string info_text(const Json& result) {
  std::string text;
  for (const auto& [key, value] : result.items()) {
    if (key == "curve" || key == "levels") continue;
    text += key == "metadata" ? metadata_lines(value) : line(key, value);
  }
  const bool has_levels = result.contains("levels");
  if (has_levels) text += "\n" + level_table(result.at("levels"));
  return result.contains("curve") ? text + curve_table(result.at("curve"), has_levels) : text;
}

}  // namespace bodyopt::cli
