#include "shots/session/view_settings.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/json_fields.h"
#include "base/wording.h"
#include "runtime/core/error.h"
#include "shots/session/between_keys.h"
#include "shots/session/setting_fields.h"

namespace bodyopt {
namespace {

void require_sections(const std::map<std::string, bool>& panels, const std::filesystem::path& path) {
  std::vector<std::string> known = section_names();
  known.emplace_back(kSidePanel);
  for (const auto& [name, open] : panels) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw Error(ErrorKind::file, path.string() + ": 'hud.panels' has '" + name +
                                     "', which is no section of the side panel; the nearest is '" +
                                     nearest_names(known, name).front() + "'");
  }
}

}  // namespace

CameraKey blended(const CameraKey& a, const CameraKey& b, double t) {
  CameraKey key = a;
  key.target = (1 - t) * a.target + t * b.target;
  key.distance = std::lerp(a.distance, b.distance, t);
  constexpr double kTurn = 2 * std::numbers::pi;
  const auto turned = [&](double from, double to) {
    return std::remainder(from + t * std::remainder(to - from, kTurn), kTurn);
  };
  key.azimuth = turned(a.azimuth, b.azimuth);
  key.roll = turned(a.roll, b.roll);
  key.vertical_angle = std::lerp(a.vertical_angle, b.vertical_angle, t);
  key.elevation = std::lerp(a.elevation, b.elevation, t);
  return key;
}

ViewSettings read_view_settings(const std::filesystem::path& path) {
  Json json = read_json(path, kViewSchema);
  json.erase("schema");
  ViewSettings settings;
  FieldReader reader(json, path, "the file");
  kSettingsFields(reader, settings);
  reader.finish();
  require_good_settings(settings, path);
  return settings;
}

void require_good_settings(const ViewSettings& settings, const std::filesystem::path& path) {
  require_sections(settings.hud.panels, path);
  const auto& [in, out] = std::pair(settings.playback.in, settings.playback.out);
  if (in && out && *in > *out) {
    throw Error(ErrorKind::file, path.string() + ": 'playback' has 'in' " + std::to_string(*in) + " after 'out' " +
                                     std::to_string(*out) + ", expected a range: the other way round?");
  }
}

void write_view_settings(const ViewSettings& settings, const std::filesystem::path& path) {
  FieldWriter writer;
  kSettingsFields(writer, settings);
  Json json = {{"schema", kViewSchema}};
  json.update(writer.json());
  write_json(json, path);
}

}  // namespace bodyopt
