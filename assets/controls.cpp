#include "assets/controls.h"

#include <algorithm>
#include <cmath>

#include "assets/json_file.h"

namespace bodyopt {
namespace {

constexpr const char* kSchema = "bodyopt-controls-1";

struct Key {
  double frame, value;
};

// A number, or [[frame, value], ...] with rising frames.
std::vector<Key> read_curve(const Json& json, const JsonObject& place, const std::string& name) {
  const auto number = [&](const Json& value, double limit) {
    const double x = value.is_number() ? value.get<double>() : std::nan("");
    if (!(std::abs(x) <= limit)) place.refuse("'" + name + "' holds " + value.dump() + ", expected a finite number");
    return x;
  };
  constexpr double kLargestFrame = 1e9, kLargestValue = 1e6;
  if (json.is_number()) return {{0, number(json, kLargestValue)}};
  if (!json.is_array() || json.empty()) place.refuse("'" + name + "' is neither a number nor a list of [frame, value]");
  std::vector<Key> curve;
  for (const Json& key : json) {
    if (!key.is_array() || key.size() != 2) place.refuse("'" + name + "' has a key that is not [frame, value]");
    curve.push_back({number(key[0], kLargestFrame), number(key[1], kLargestValue)});
    if (curve.size() > 1 && !(curve.back().frame > curve[curve.size() - 2].frame)) {
      place.refuse("'" + name + "' has keys whose frames do not rise");
    }
  }
  return curve;
}

double value_at(const std::vector<Key>& curve, double frame) {
  const auto after = std::find_if(curve.begin(), curve.end(), [&](const Key& key) { return key.frame > frame; });
  if (after == curve.begin()) return curve.front().value;
  if (after == curve.end()) return curve.back().value;
  const Key &a = after[-1], &b = *after;
  return std::lerp(a.value, b.value, (frame - a.frame) / (b.frame - a.frame));
}

}  // namespace

void read_controls(const std::filesystem::path& path, Clip& clip) {
  const Json json = read_json(path, kSchema);
  const JsonObject top(json, path, "the file");
  top.allow({"schema", "controls"});
  if (!top.has("controls") || !json["controls"].is_object())
    top.refuse("lacks 'controls', an object of curves by name");
  clip.controls.clear();
  for (Pose& pose : clip.poses) pose.controls.clear();
  for (const auto& [name, value] : json["controls"].items()) {
    const std::vector<Key> curve = read_curve(value, top, name);
    clip.controls.push_back(name);
    for (std::size_t k = 0; k < clip.poses.size(); ++k) {
      const double frame = clip.first_frame + static_cast<double>(k);
      clip.poses[k].controls.push_back(static_cast<float>(value_at(curve, frame)));
    }
  }
}

std::vector<std::string> arrange_controls(const std::vector<std::string>& names, Clip& clip) {
  for (Pose& pose : clip.poses) {
    std::vector<float> arranged;
    for (const std::string& name : names) {
      const auto at = std::find(clip.controls.begin(), clip.controls.end(), name) - clip.controls.begin();
      arranged.push_back(at < std::ssize(clip.controls) ? pose.controls[static_cast<std::size_t>(at)] : 0.0f);
    }
    pose.controls = std::move(arranged);
  }
  std::vector<std::string> unknown;
  for (const std::string& name : clip.controls) {
    if (std::find(names.begin(), names.end(), name) == names.end()) unknown.push_back(name);
  }
  clip.controls = names;
  return unknown;
}

}  // namespace bodyopt
