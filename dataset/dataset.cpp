#include "dataset/dataset.h"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "assets/clips/clip.h"
#include "assets/clips/clip_source.h"
#include "base/frame_range.h"
#include "base/json_file.h"
#include "dataset/modifier.h"
#include "runtime/core/error.h"
#include "runtime/core/file_problem.h"
#include "runtime/core/text.h"

namespace bodyopt {
namespace {

constexpr const char* kDatasetSchema = "bodyopt-dataset-1";
constexpr const char* kStatusSchema = "bodyopt-frame-status-1";
constexpr double kNoResidual = std::numeric_limits<double>::infinity();  // null: the solver blew up or gave up
constexpr double kConverged = 1e-4;      // residual below which a frame counts as solved
constexpr std::size_t kMaxReason = 300;  // characters of a message about text that may be long

std::vector<int> frames_of(const JsonObject& take, const char* key) {
  const std::string text = take.text(key);
  if (text.empty()) return {};
  try {
    return parse_frame_range(text);
  } catch (const Error& error) {
    take.refuse("'", key, "': ", std::string(error.what()).substr(0, kMaxReason));
  }
}

// Range text for frames in any order: ranges rise, so every stretch that rises is formatted by itself.
std::string range_text(const std::vector<int>& frames, const DatasetTake& take, const std::filesystem::path& path) {
  std::string text;
  for (auto begin = frames.begin(); begin != frames.end();) {
    const auto end = std::is_sorted_until(begin, frames.end());
    if (!text.empty()) text += ',';
    text += format_frame_range({begin, end});
    begin = end;
  }
  if (!frames.empty() && parse_frame_range(text) != frames) {
    throw Error(ErrorKind::file, path, ": cannot be written: take '", take.name,
                "' names a frame twice, expected every frame once");
  }
  return text;
}

std::string relative_path(const std::string& name, const std::filesystem::path& folder) {
  if (!std::filesystem::path(name).is_absolute()) return name;
  return std::filesystem::proximate(name, folder).string();
}

// FILE or FILE#name.
std::string relative_clip(const std::string& clip, const std::filesystem::path& folder) {
  const ClipSource source = split_source(clip);
  return relative_path(source.path.string(), folder) + (source.name.empty() ? "" : '#' + source.name);
}

// Names all that the takes of one dataset must share.
std::string described(const Dataset& dataset) {
  std::ostringstream text;
  text << "'" << dataset.character << "' (unit " << (dataset.unit > 0 ? dataset.unit : 1.0) << " m) with muscles '"
       << dataset.muscles << "' and materials '" << dataset.materials << "'";
  if (dataset.body_fat > 0) text << ", body fat " << dataset.body_fat;
  if (!dataset.kind.empty()) text << ", kind '" << dataset.kind << "'";
  if (!dataset.corrections.empty()) text << ", corrections '" << dataset.corrections << "'";
  return text.str();
}

DatasetTake read_take(const JsonObject& json) {
  json.allow({"name", "clip", "fps", "first_frame", "frames", "controls", "joint_map", "up", "shapes", "shapes_status",
              "heldout", "carried", "as_given"});
  DatasetTake take;
  take.name = json.name("name");
  take.clip = json.name("clip");
  take.fps = json.number("fps", 1e-3, 1e5);
  take.first_frame = json.integer("first_frame");
  take.frames = frames_of(json, "frames");
  if (json.has("controls")) take.controls = json.name("controls");
  if (json.has("joint_map")) take.joint_map = json.name("joint_map");
  if (json.has("up")) take.up = json.name("up");
  take.shapes = json.name("shapes");
  if (json.has("shapes_status")) take.shapes_status = json.text("shapes_status");
  if (json.has("heldout")) take.heldout = frames_of(json, "heldout");
  if (json.has("carried")) take.carried = json.boolean("carried");
  if (json.has("as_given")) take.as_given = json.boolean("as_given");
  if (take.frames.empty()) json.refuse("names no frames");
  const std::set<int> known(take.frames.begin(), take.frames.end());
  for (const int frame : take.heldout) {
    if (!known.contains(frame)) json.refuse("holds out frame ", frame, ", which it does not have");
  }
  return take;
}

Json to_json(const Dataset& dataset, const std::filesystem::path& path) {
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  Json json = {{"schema", kDatasetSchema}, {"character", relative_path(dataset.character, folder)}};
  if (dataset.unit > 0) json["unit"] = dataset.unit;
  if (!dataset.muscles.empty()) json["muscles"] = relative_path(dataset.muscles, folder);
  if (!dataset.materials.empty()) json["materials"] = relative_path(dataset.materials, folder);
  if (dataset.body_fat > 0) json["body_fat"] = dataset.body_fat;
  if (!dataset.kind.empty()) json["kind"] = dataset.kind;
  if (!dataset.corrections.empty()) json["corrections"] = relative_path(dataset.corrections, folder);
  if (!dataset.regions.empty()) json["regions"] = relative_path(dataset.regions, folder);
  json["takes"] = Json::array();
  for (const DatasetTake& take : dataset.takes) {
    Json entry = {{"name", take.name},
                  {"clip", relative_clip(take.clip, folder)},
                  {"fps", take.fps},
                  {"first_frame", take.first_frame},
                  {"frames", range_text(take.frames, take, path)},
                  {"shapes", relative_path(take.shapes, folder)}};
    if (!take.controls.empty()) entry["controls"] = relative_path(take.controls, folder);
    if (!take.joint_map.empty()) entry["joint_map"] = relative_path(take.joint_map, folder);
    if (!take.up.empty()) entry["up"] = take.up;
    if (!take.shapes_status.empty()) entry["shapes_status"] = relative_path(take.shapes_status, folder);
    if (!take.heldout.empty()) entry["heldout"] = range_text(take.heldout, take, path);
    if (take.carried) entry["carried"] = true;
    if (take.as_given) entry["as_given"] = true;
    json["takes"].push_back(entry);
  }
  for (const NamedSelection& selection : dataset.selections) json["selections"][selection.name] = selection.frames;
  if (!dataset.modifiers.empty()) json["modifiers"] = to_json(dataset.modifiers);
  return json;
}

Dataset with_take(Dataset dataset, const DatasetTake& take) {
  const auto place = std::ranges::find(dataset.takes, take.name, &DatasetTake::name);
  if (place == dataset.takes.end()) {
    dataset.takes.push_back(take);
  } else {
    *place = take;
  }
  return dataset;
}

}  // namespace

std::uint64_t file_hash(const std::filesystem::path& path) {
  require_file(path);
  std::ifstream file(path, std::ios::binary);
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), &XXH3_freeState);
  XXH3_64bits_reset(state.get());
  std::array<char, 1 << 16> bytes;
  while (file.read(bytes.data(), bytes.size()) || file.gcount() > 0) {
    XXH3_64bits_update(state.get(), bytes.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (!file.eof()) throw Error(ErrorKind::file, path, ": ", why_unreadable(path));
  return XXH3_64bits_digest(state.get());
}

namespace {

// The clip's file, relative as the take names it, without the name of a clip within.
std::string clip_file(const Dataset& dataset, const DatasetTake& take) {
  const std::string source = (dataset.folder / take.clip).string();
  return take.clip.substr(0, take.clip.size() - (source.size() - split_source(source).path.string().size()));
}

}  // namespace

std::vector<HashedFile> hashed_files(const Dataset& dataset) {
  std::vector<HashedFile> files;
  std::set<std::string> known;
  const auto add = [&](const std::string& what, const std::string& path) {
    if (!path.empty() && known.insert(path).second) files.push_back({what, path, file_hash(dataset.folder / path)});
  };
  add("character", dataset.character);
  add("muscles", dataset.muscles);
  add("materials", dataset.materials);
  add("corrections", dataset.corrections);
  add("regions", dataset.regions);
  for (const DatasetTake& take : dataset.takes) {
    const std::string of_take = "take '" + take.name + "': ";
    add(of_take + "clip", clip_file(dataset, take));
    add(of_take + "controls", take.controls);
    add(of_take + "joint map", take.joint_map);
    add(of_take + "shapes", take.shapes);
    add(of_take + "side-car", take.shapes_status);
  }
  return files;
}

Clip read_clip(const Dataset& dataset, const DatasetTake& take, const Skeleton& skeleton) {
  ClipOptions options;
  options.fps = take.fps;
  options.first_frame = take.first_frame;
  const std::string source = (dataset.folder / take.clip).string();
  options.unit = clip_unit(source, dataset.unit);
  options.up = take.up;
  if (!take.controls.empty()) options.controls = (dataset.folder / take.controls).string();
  if (!take.joint_map.empty()) options.joint_map = (dataset.folder / take.joint_map).string();
  return read_clip(source, skeleton, options);
}

void require_same_motion(const DatasetTake& there, const DatasetTake& asked) {
  if (there.clip == asked.clip && there.fps == asked.fps && there.first_frame == asked.first_frame &&
      there.controls == asked.controls && there.joint_map == asked.joint_map && there.up == asked.up) {
    return;
  }
  const auto described = [](const DatasetTake& take) {
    std::ostringstream text;
    text << "'" << take.clip << "' at " << take.fps << " frames a second from frame " << take.first_frame
         << ", controls '" << take.controls << "'";
    if (!take.joint_map.empty()) text << ", joint map '" << take.joint_map << "'";
    if (!take.up.empty()) text << ", up " << take.up;
    return text.str();
  };
  throw Error(ErrorKind::mismatch, "the dataset has a take '", there.name, "' already, of ", described(there),
              "; asked for ", described(asked), ": give the new one a --name");
}

Dataset::Dataset() = default;
Dataset::Dataset(const Dataset& other) = default;
Dataset::Dataset(Dataset&& other) noexcept = default;
Dataset& Dataset::operator=(const Dataset& other) = default;
Dataset& Dataset::operator=(Dataset&& other) noexcept = default;
Dataset::~Dataset() = default;

Dataset read_dataset(const std::filesystem::path& path) {
  const JsonFile top(path, kDatasetSchema, "the dataset",
                     {"schema", "character", "unit", "muscles", "materials", "body_fat", "kind", "corrections",
                      "regions", "takes", "selections", "modifiers"});
  Dataset dataset;
  dataset.folder = path.parent_path().empty() ? "." : path.parent_path();
  dataset.character = top.name("character");
  if (top.has("unit")) dataset.unit = top.number("unit", 0, 1e6);
  if (top.has("muscles")) dataset.muscles = top.text("muscles");
  if (top.has("materials")) dataset.materials = top.name("materials");
  if (top.has("body_fat")) dataset.body_fat = top.number("body_fat", 0.02, 0.6);
  if (top.has("kind")) dataset.kind = top.name("kind");
  if (top.has("corrections")) dataset.corrections = top.name("corrections");
  if (top.has("regions")) dataset.regions = top.name("regions");
  std::set<std::string> names;
  for (const JsonObject& take : top.objects("takes")) {
    dataset.takes.push_back(read_take(take));
    if (!names.insert(dataset.takes.back().name).second) take.refuse("has the name of an earlier take");
  }
  if (top.has("selections")) {
    const JsonObject selections(top.json()["selections"], path, "'selections'");
    for (const auto& [name, frames] : selections.json().items()) dataset.selections.push_back({name, frames});
  }
  if (top.has("modifiers")) dataset.modifiers = read_modifiers(top.array("modifiers"), path);
  return dataset;
}

Dataset open_dataset(const Dataset& asked, const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return asked;
  Dataset there = read_dataset(path);
  const std::string found = described(there), wanted = described(asked);
  if (found == wanted) return there;
  throw Error(ErrorKind::mismatch, path, " holds shapes of ", found, "; asked for ", wanted, ": use another folder");
}

void write_dataset(const Dataset& dataset, const std::filesystem::path& path) {
  write_json(to_json(dataset, path), path);
}

void require_place_for(const Dataset& asked, const DatasetTake& take, const std::filesystem::path& path) {
  const FileLock lock = lock_to_change(path);
  text_of(to_json(with_take(open_dataset(asked, path), take), path), path);
  const AtomicFile probe(path);
}

Dataset put_take(const Dataset& asked, const DatasetTake& take, const std::filesystem::path& path) {
  const FileLock lock = lock_to_change(path);
  const Dataset dataset = with_take(open_dataset(asked, path), take);
  write_dataset(dataset, path);
  return dataset;
}

std::vector<FrameStatus> read_frame_status(const std::filesystem::path& path) {
  const JsonFile top(path, kStatusSchema, "the side-car", {"schema", "frames"});
  std::vector<FrameStatus> status;
  std::set<int> known;
  for (const JsonObject& frame : top.objects("frames")) {
    frame.allow({"frame", "residual", "converged", "iterations", "seconds", "inverted_tets", "contact_depth",
                 "volume_change", "discretisation_error", "inputs"});
    FrameStatus entry;
    entry.frame = frame.integer("frame");
    entry.residual = frame.is_null("residual") ? kNoResidual : frame.number("residual", 0, 1e300);
    entry.converged = frame.boolean("converged");
    entry.iterations = frame.integer("iterations", 0);
    entry.seconds = frame.number("seconds", 0, 1e9);
    entry.inverted_tets = frame.integer("inverted_tets", 0);
    if (frame.has("contact_depth") && !frame.is_null("contact_depth"))
      entry.contact_depth = frame.number("contact_depth", 0, 1e9);
    if (frame.has("volume_change") && !frame.is_null("volume_change"))  // below -1: turned inside out
      entry.volume_change = frame.number("volume_change", -1e9, 1e9);
    if (frame.has("discretisation_error")) entry.discretisation_error = frame.number("discretisation_error", 0, 1e9);
    if (frame.has("inputs")) entry.inputs = frame.hash("inputs");
    if (!known.insert(entry.frame).second) frame.refuse("names frame ", entry.frame, " again");
    if (entry.converged && !(entry.residual < kConverged && entry.inverted_tets == 0)) {
      frame.refuse("says 'converged' of a frame with a residual of 1e-4 or more, or inverted tets: edited by hand?");
    }
    status.push_back(entry);
  }
  return status;
}

void write_frame_status(const std::vector<FrameStatus>& status, const std::filesystem::path& path) {
  Json frames = Json::array();
  for (const FrameStatus& entry : status) {
    Json frame = {{"frame", entry.frame},
                  {"residual", std::isfinite(entry.residual) ? Json(entry.residual) : Json()},
                  {"converged", entry.converged},
                  {"iterations", entry.iterations},
                  {"seconds", entry.seconds},
                  {"inverted_tets", entry.inverted_tets},
                  {"contact_depth", std::isfinite(entry.contact_depth) ? Json(entry.contact_depth) : Json()},
                  {"volume_change", std::isfinite(entry.volume_change) ? Json(entry.volume_change) : Json()}};
    if (std::isfinite(entry.discretisation_error)) frame["discretisation_error"] = entry.discretisation_error;
    if (entry.inputs != 0) frame["inputs"] = hexadecimal(entry.inputs);
    frames.push_back(frame);
  }
  write_json({{"schema", kStatusSchema}, {"frames", frames}}, path);
}

std::set<int> replaced_frames(const Dataset& dataset, const DatasetTake& take) {
  std::set<int> frames;
  for (const Modifier& modifier : dataset.modifiers) {
    const Json& parameters = modifier.parameters;
    const bool whole = modifier.type == "blend" && modifier.enabled && modifier.strength == 1 &&
                       modifier.frames.empty() && modifier.mask.empty();
    const auto has_text = [&](const char* key) { return parameters.contains(key) && parameters[key].is_string(); };
    if (!whole || !has_text("take") || !has_text("frames") || parameters["take"] != take.name) continue;
    for (const int frame : parse_frame_range(parameters["frames"].get<std::string>())) frames.insert(frame);
  }
  return frames;
}

std::set<int> unconverged_frames(const Dataset& dataset, const DatasetTake& take) {
  if (take.shapes_status.empty()) return {};
  std::set<int> frames(take.frames.begin(), take.frames.end());
  for (const FrameStatus& status : read_frame_status(dataset.folder / take.shapes_status)) {
    if (status.converged) frames.erase(status.frame);
  }
  for (const int frame : replaced_frames(dataset, take)) frames.erase(frame);
  return frames;
}

bool has_given_shapes(const Dataset& dataset, const DatasetTake& take) {
  if (take.shapes_status.empty()) return true;
  // Named but missing: a simulation was killed just before it wrote it.
  if (!std::filesystem::exists(dataset.folder / take.shapes_status)) return false;
  std::set<int> given(take.frames.begin(), take.frames.end());
  for (const FrameStatus& status : read_frame_status(dataset.folder / take.shapes_status)) {
    if (status.inputs != 0) given.erase(status.frame);
  }
  return !given.empty();
}

TakeLock::TakeLock(std::filesystem::path cache, const std::string& instead)
    : cache_(std::move(cache)),
      lock_(std::filesystem::path(cache_).replace_extension(".lock"),
            "writing this take right now, and two would mix up its frames: wait for it to end, or " + instead) {}

}  // namespace bodyopt
