#include "trainer/transfer/markers_file.h"

#include <nlohmann/json.hpp>
#include <set>

#include "base/json_file.h"
#include "runtime/core/error.h"

namespace bodyopt::trainer {
namespace {

constexpr const char* kMarkersSchema = "bodyopt-markers-1";

}  // namespace

bool is_markers(const std::filesystem::path& path) {
  try {
    read_json(path, kMarkersSchema);
    return true;
  } catch (const Error&) {
    return false;
  }
}

void write_markers(const std::vector<SkinMarker>& markers, const std::filesystem::path& path) {
  Json list = Json::array();
  for (const auto& [source, target] : markers) list.push_back({{"source", source}, {"target", target}});
  write_json({{"schema", kMarkersSchema}, {"markers", list}}, path);
}

std::vector<SkinMarker> read_markers(const std::filesystem::path& path) {
  const Json json = read_json(path, kMarkersSchema);
  const JsonObject top(json, path, "the file");
  top.allow({"schema", "markers"});
  const std::vector<JsonObject> list = top.objects("markers");
  if (list.empty()) top.refuse("has no marker in 'markers'");
  std::vector<SkinMarker> markers;
  std::set<int> sources, targets;
  for (const JsonObject& object : list) {
    object.allow({"source", "target"});
    const int source = object.integer("source", 0), target = object.integer("target", 0);
    if (!sources.insert(source).second) object.refuse("marks vertex ", source, " of the source twice");
    if (!targets.insert(target).second) object.refuse("marks vertex ", target, " of the target twice");
    markers.push_back({static_cast<std::uint32_t>(source), static_cast<std::uint32_t>(target)});
  }
  return markers;
}

}  // namespace bodyopt::trainer
