#include "trainer/dataset/dataset.h"

#include <algorithm>
#include <set>

#include "runtime/basis/error.h"
#include "trainer/dataset/frame_range.h"
#include "trainer/dataset/json_file.h"

namespace bodyopt {
namespace {

constexpr const char* kDatasetSchema = "bodyopt-dataset-1";
constexpr const char* kStatusSchema = "bodyopt-frame-status-1";

std::vector<int> frames_of(const JsonObject& take, const char* key) {
  const std::string text = take.text(key);
  if (text.empty()) return {};
  try {
    return parse_frame_range(text);
  } catch (const Error& error) {
    take.refuse(std::string("'") + key + "': " + error.what());
  }
}

DatasetTake read_take(const JsonObject& json) {
  json.allow({"name", "clip", "fps", "first_frame", "frames", "shapes", "shapes_status", "heldout"});
  DatasetTake take;
  take.name = json.text("name");
  take.clip = json.text("clip");
  take.fps = json.number("fps", 1e-3, 1e5);
  take.first_frame = json.integer("first_frame");
  take.frames = frames_of(json, "frames");
  take.shapes = json.text("shapes");
  if (json.has("shapes_status")) take.shapes_status = json.text("shapes_status");
  if (json.has("heldout")) take.heldout = frames_of(json, "heldout");
  if (take.frames.empty()) json.refuse("names no frames");
  const std::set<int> known(take.frames.begin(), take.frames.end());
  for (const int frame : take.heldout) {
    if (!known.contains(frame)) json.refuse("holds out frame " + std::to_string(frame) + ", which it does not have");
  }
  return take;
}

}  // namespace

Dataset read_dataset(const std::filesystem::path& path) {
  const Json json = read_json(path, kDatasetSchema);
  const JsonObject top(json, path, "the dataset");
  top.allow({"schema", "character", "unit", "muscles", "takes"});
  Dataset dataset;
  dataset.folder = path.parent_path().empty() ? "." : path.parent_path();
  dataset.character = top.text("character");
  if (top.has("unit")) dataset.unit = top.number("unit", 0, 1e6);
  if (top.has("muscles")) dataset.muscles = top.text("muscles");
  std::set<std::string> names;
  const Json& takes = top.array("takes");
  for (std::size_t k = 0; k < takes.size(); ++k) {
    const JsonObject take(takes[k], path, "takes[" + std::to_string(k) + "]");
    dataset.takes.push_back(read_take(take));
    if (!names.insert(dataset.takes.back().name).second) take.refuse("has the name of an earlier take");
  }
  return dataset;
}

void write_dataset(const Dataset& dataset, const std::filesystem::path& path) {
  Json json = {{"schema", kDatasetSchema}, {"character", dataset.character}};
  if (dataset.unit > 0) json["unit"] = dataset.unit;
  if (!dataset.muscles.empty()) json["muscles"] = dataset.muscles;
  json["takes"] = Json::array();
  for (const DatasetTake& take : dataset.takes) {
    Json entry = {{"name", take.name},
                  {"clip", take.clip},
                  {"fps", take.fps},
                  {"first_frame", take.first_frame},
                  {"frames", format_frame_range(take.frames)},
                  {"shapes", take.shapes}};
    if (!take.shapes_status.empty()) entry["shapes_status"] = take.shapes_status;
    if (!take.heldout.empty()) entry["heldout"] = format_frame_range(take.heldout);
    json["takes"].push_back(entry);
  }
  write_json(json, path);
}

std::vector<FrameStatus> read_frame_status(const std::filesystem::path& path) {
  const Json json = read_json(path, kStatusSchema);
  const JsonObject top(json, path, "the side-car");
  top.allow({"schema", "frames"});
  std::vector<FrameStatus> status;
  const Json& frames = top.array("frames");
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const JsonObject frame(frames[k], path, "frames[" + std::to_string(k) + "]");
    frame.allow({"frame", "residual", "converged", "iterations", "seconds", "inverted_tets"});
    FrameStatus entry;
    entry.frame = frame.integer("frame");
    entry.residual = frame.number("residual", 0, 1e300);
    entry.converged = frame.boolean("converged");
    entry.iterations = frame.integer("iterations", 0);
    entry.seconds = frame.number("seconds", 0, 1e9);
    entry.inverted_tets = frame.integer("inverted_tets", 0);
    status.push_back(entry);
  }
  return status;
}

void write_frame_status(const std::vector<FrameStatus>& status, const std::filesystem::path& path) {
  Json frames = Json::array();
  for (const FrameStatus& entry : status) {
    frames.push_back({{"frame", entry.frame},
                      {"residual", entry.residual},
                      {"converged", entry.converged},
                      {"iterations", entry.iterations},
                      {"seconds", entry.seconds},
                      {"inverted_tets", entry.inverted_tets}});
  }
  write_json({{"schema", kStatusSchema}, {"frames", frames}}, path);
}

}  // namespace bodyopt
