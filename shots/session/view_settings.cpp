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

namespace bodyopt::shots {
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

CameraKey eased_between(const KeySpan<CameraKey>& span) {
  const CameraKey &a = span.a, &b = span.b, *before = span.before, *after = span.after;
  if (a.ease != KeyEase::spline) return blended(a, b, eased(a.ease, span.x));
  CameraKey key = a;
  // `turn`: after so much the number is the same again; 0: never.
  const auto go = [&](const auto& number, double turn = 0) {
    const auto near = [&](double value, double to) { return turn > 0 ? to + std::remainder(value - to, turn) : value; };
    SplineValues values{{}, number(a), near(number(b), number(a)), {}, before ? before->ease : a.ease, b.ease};
    if (before) values.before = near(number(*before), values.a);
    if (after) values.after = near(number(*after), values.b);
    number(key) = near(spline_between(values, span), 0);
  };
  constexpr double kTurn = 2 * std::numbers::pi;
  const auto go_member = [&](double OrbitView::*member, double turn = 0) {
    const auto number = [member](auto& camera) -> auto& { return camera.*member; };
    go(number, turn);
  };
  for (std::size_t i = 0; i < 3; ++i) {
    const auto number = [i](auto& camera) -> auto& { return camera.target[i]; };
    go(number);
  }
  go_member(&OrbitView::distance);
  go_member(&OrbitView::azimuth, kTurn);
  go_member(&OrbitView::elevation);
  go_member(&OrbitView::roll, kTurn);
  go_member(&OrbitView::vertical_angle);
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

}  // namespace bodyopt::shots
