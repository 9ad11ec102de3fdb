#include "assets/clips/controls.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <utility>

#include "base/json_file.h"
#include "base/wording.h"
#include "runtime/basis/read_file.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr const char* kSchema = "bodyopt-controls-1";

constexpr double kLargestFrame = 1e9, kLargestValue = 1e6;

struct Key {
  double frame, value;
};

// A number, or [[frame, value], ...] with rising frames.
std::vector<Key> read_curve(const Json& json, const JsonObject& place, const std::string& name) {
  const auto number = [&](const Json& value, double limit) {
    const double x = value.is_number() ? value.get<double>() : std::nan("");
    if (!(std::abs(x) <= limit)) place.refuse("'", name, "' holds ", value.dump(), ", expected a finite number");
    return x;
  };
  if (json.is_number()) return {{0, number(json, kLargestValue)}};
  if (!json.is_array() || json.empty()) place.refuse("'", name, "' is neither a number nor a list of [frame, value]");
  std::vector<Key> curve;
  for (const Json& key : json) {
    if (!key.is_array() || key.size() != 2) place.refuse("'", name, "' has a key that is not [frame, value]");
    curve.push_back({number(key[0], kLargestFrame), number(key[1], kLargestValue)});
    if (curve.size() > 1 && !(curve.back().frame > curve[curve.size() - 2].frame)) {
      place.refuse("'", name, "' has keys whose frames do not rise");
    }
  }
  return curve;
}

double value_at(const std::vector<Key>& curve, double frame) {
  const auto after = std::ranges::find_if(curve, [&](const Key& key) { return key.frame > frame; });
  if (after == curve.begin()) return curve.front().value;
  if (after == curve.end()) return curve.back().value;
  const Key &a = after[-1], &b = *after;
  return std::lerp(a.value, b.value, (frame - a.frame) / (b.frame - a.frame));
}

using Curves = std::vector<std::pair<std::string, std::vector<Key>>>;

Curves read_json_curves(const std::filesystem::path& path, const Clip& clip) {
  const JsonFile top(path, kSchema, "the file", {"schema", "fps", "controls"});
  const Json& json = top.json();
  if (!top.has("controls") || !json["controls"].is_object())
    top.refuse("lacks 'controls', an object of curves by name");
  const double rate = top.has("fps") ? top.number("fps", 1e-3, 1e5) : clip.fps;
  if (std::abs(rate - clip.fps) > 1e-3 * rate) {
    throw Error(ErrorKind::mismatch, path, ": its frames are ", rounded(rate), " a second, those of the clip ",
                rounded(clip.fps), ": sample the clip with --fps ", rounded(rate));
  }
  Curves curves;
  for (const auto& [name, value] : json["controls"].items()) curves.emplace_back(name, read_curve(value, top, name));
  return curves;
}

std::vector<std::string> csv_cells(std::string line) {
  if (line.ends_with('\r')) line.pop_back();
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  if (line.ends_with(',')) cells.emplace_back();
  return cells;
}

// A column "frame", which rises, and one for each control.
Curves read_csv_curves(const std::filesystem::path& path) {
  constexpr std::uint64_t kMostBytes = 64 << 20;
  std::istringstream text(read_file(path, kMostBytes, "a table of controls"));
  std::string line;
  std::getline(text, line);
  const std::vector<std::string> names = csv_cells(line);
  const auto refuse = [&](std::size_t number, const auto&... what) {
    throw Error(ErrorKind::file, path, ", line ", number, ": ", what...);
  };
  if (names.size() < 2 || names[0] != "frame" || std::set(names.begin(), names.end()).size() != names.size()) {
    refuse(1, "expected 'frame', and the names of controls, each once, parted by commas");
  }
  Curves curves;
  for (std::size_t c = 1; c < names.size(); ++c) curves.push_back({names[c], {}});
  for (std::size_t number = 2; std::getline(text, line); ++number) {
    const std::vector<std::string> cells = csv_cells(line);
    if (cells.empty()) continue;
    if (cells.size() != names.size()) refuse(number, "has ", cells.size(), " cells, expected ", names.size());
    std::vector<double> values;
    for (const std::string& cell : cells) {
      char* end = nullptr;
      values.push_back(std::strtod(cell.c_str(), &end));
      if (cell.empty() || *end != '\0' || !(std::abs(values.back()) <= kLargestFrame)) {
        refuse(number, "holds '", cell, "', expected a finite number");
      }
    }
    std::vector<Key>& first = curves.front().second;
    if (!first.empty() && !(values[0] > first.back().frame)) refuse(number, "has a frame that does not rise");
    for (std::size_t c = 0; c < curves.size(); ++c) curves[c].second.push_back({values[0], values[c + 1]});
  }
  if (curves.front().second.empty()) refuse(2, "expected a row of numbers, found none");
  return curves;
}

// Curves whose keys all lie on one side of a clip.
struct CurvesBeyond {
  std::vector<std::string> names;
  double first = kLargestFrame, last = -kLargestFrame;

  void add(const std::string& name, const std::vector<Key>& keys) {
    names.push_back(name);
    first = std::min(first, keys.front().frame);
    last = std::max(last, keys.back().frame);
  }
  std::string text() const {
    return "of " + list_names(names) + ", from frame " + rounded(first) + " to " + rounded(last) + ",";
  }
};

// Keys that all lie beyond the clip are most likely of another numbering. One note, however many curves have such.
void note_other_frames(const std::filesystem::path& path, const Curves& curves, Clip& clip) {
  CurvesBeyond before, after;
  for (const auto& [name, keys] : curves) {
    if (keys.size() < 2) continue;
    if (keys.back().frame < clip.first_frame) before.add(name, keys);
    if (keys.front().frame > clip.last_frame()) after.add(name, keys);
  }
  const std::size_t count = before.names.size() + after.names.size();
  if (count == 0) return;
  std::string text = before.names.empty() ? "" : " " + before.text();
  if (!after.names.empty()) text += (text.empty() ? " " : " and ") + after.text();
  clip.notes.push_back(path.string() + ": the keys" + text + " are none within the clip's " +
                       std::to_string(clip.first_frame) + " to " + std::to_string(clip.last_frame()) + ": " +
                       (count == 1 ? "it is" : "they are") + " held all along (another first frame, or rate?)");
}

}  // namespace

void read_controls(const std::filesystem::path& path, Clip& clip) {
  const Curves curves = path.extension() == ".csv" ? read_csv_curves(path) : read_json_curves(path, clip);
  note_other_frames(path, curves, clip);
  clip.controls.clear();
  for (Pose& pose : clip.poses) pose.controls.clear();
  for (const auto& [name, curve] : curves) {
    clip.controls.push_back(name);
    for (std::size_t k = 0; k < clip.poses.size(); ++k) {
      const double frame = clip.first_frame + static_cast<double>(k);
      clip.poses[k].controls.push_back(static_cast<float>(value_at(curve, frame)));
    }
  }
}

void write_controls(const Clip& clip, const std::filesystem::path& path) {
  Json controls = Json::object();
  for (std::size_t c = 0; c < clip.controls.size(); ++c) {
    const auto same_as_first = [&](const Pose& pose) { return pose.controls[c] == clip.poses.front().controls[c]; };
    if (std::ranges::all_of(clip.poses, same_as_first)) {
      controls[clip.controls[c]] = clip.poses.front().controls[c];
      continue;
    }
    Json& curve = controls[clip.controls[c]] = Json::array();
    for (std::size_t k = 0; k < clip.poses.size(); ++k) {
      curve.push_back({clip.first_frame + static_cast<int>(k), clip.poses[k].controls[c]});
    }
  }
  write_json({{"schema", kSchema}, {"controls", controls}}, path);
}

std::vector<std::string> arrange_controls(const std::vector<std::string>& names, Clip& clip) {
  for (Pose& pose : clip.poses) {
    std::vector<float> arranged;
    for (const std::string& name : names) {
      const auto at = std::ranges::find(clip.controls, name) - clip.controls.begin();
      arranged.push_back(at < std::ssize(clip.controls) ? pose.controls[static_cast<std::size_t>(at)] : 0.0f);
    }
    pose.controls = std::move(arranged);
  }
  std::vector<std::string> unknown;
  for (const std::string& name : clip.controls) {
    if (std::ranges::find(names, name) == names.end()) unknown.push_back(name);
  }
  clip.controls = names;
  return unknown;
}

}  // namespace bodyopt
