#include "shots/session/view_settings.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "assets/json_fields.h"
#include "assets/wording.h"
#include "runtime/core/error.h"
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
