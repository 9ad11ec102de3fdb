// bodyopt info: what a file holds.
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "assets/caches/nodes_cache.h"
#include "assets/caches/pc2.h"
#include "assets/characters/character.h"
#include "assets/clips/bvh.h"
#include "assets/clips/clip_source.h"
#include "assets/clips/gltf_clip.h"
#include "assets/gltf/gltf_file.h"
#include "assets/gltf/gltf_skeleton.h"
#include "base/frame_range.h"
#include "base/json_file.h"
#include "cli/arguments/common.h"
#include "cli/results/attachments.h"
#include "cli/results/measure.h"
#include "dataset/dataset.h"
#include "geometry/mesh.h"
#include "runtime/basis/dynamics.h"
#include "runtime/basis/safetensors.h"
#include "runtime/core/error.h"
#include "runtime/core/file_kind.h"
#include "runtime/core/file_problem.h"
#include "runtime/core/transformed.h"
#include "runtime/host/jiggle.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "trainer/train/data/learned_poses.h"
#include "trainer/train/pack/trade_off.h"

namespace bodyopt::cli {
namespace {

constexpr std::size_t kLong = 8, kMostShown = 64;  // entries: of what is within an entry; of a list

bool is_list_of_objects(const Json& value) {
  return value.is_array() && !value.empty() && std::ranges::all_of(value, [](const Json& v) { return v.is_object(); });
}

std::string value_text(const Json& value);

// Counted, where it is long.
std::string text_within(const Json& value) {
  if (!value.is_structured() || (value.size() <= kLong && !is_list_of_objects(value))) return value_text(value);
  return format("{} (--json names them)", value.size());
}

// "vertices 12, name shirt"; "Hips, Spine".
std::string value_text(const Json& value) {
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
  if (!is_list_of_objects(value)) return format("{:18} {}\n", key, value_text(value));
  std::string text;
  for (std::size_t k = 0; k < value.size(); ++k) {
    text += format("{:18} {}\n", k == 0 ? key : "", value_text(value[k]));
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

// A line per entry, then the tables. Long values of an entry are only counted: JSON has them whole.
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

Json joint_names(const Skeleton& skeleton) { return transformed(skeleton.joints, &Joint::name); }

Json bvh_info(const std::string& path) {
  const Bvh bvh = read_bvh(path);
  const Json names = transformed(bvh.joints, &BvhJoint::name);
  return {{"kind", "motion"},
          {"frames", bvh.frame_count},
          {"frames_per_second", 1 / bvh.frame_time},
          {"seconds", bvh.duration()},
          {"joints", names}};
}

// Every clip with its frames at the default rate, or why it cannot be used.
Json clips_info(const GltfFile& file, const Skeleton& skeleton, double unit) {
  Json clips = Json::array();
  ClipOptions options;
  options.unit = unit;
  for (const std::string& name : transformed(file.model().animations, &tinygltf::Animation::name)) {
    try {
      const Clip clip = read_gltf_clip(
          file, name, [&](const std::set<std::string>&) { return skeleton; }, options);
      clips.push_back({{"name", name}, {"frames", clip.poses.size()}, {"frames_per_second", options.fps}});
    } catch (const Error& error) {
      clips.push_back({{"name", name}, {"problem", error.what()}});
    }
  }
  return clips;
}

// Motion alone, or a mesh that no joints move.
Json skinless_info(const GltfFile& file) {
  const std::vector<std::string> clips = transformed(file.model().animations, &tinygltf::Animation::name);
  if (!clips.empty()) return {{"kind", "motion"}, {"clips", clips}};
  return {{"kind", "no character"},
          {"notes", {"it has neither a skin nor clips: a mesh that joints move needs a skin (JOINTS_0, WEIGHTS_0)"}}};
}

Json scene_info(const std::string& path, double unit) {
  const GltfFile file(path);
  if (choose_skin(file) < 0) return skinless_info(file);
  const Character character = read_character(file, unit);
  const Eigen::RowVector3d box = box_sides(character.vertices);
  return {{"kind", "character"},
          {"vertices", character.output_count()},
          {"welded_vertices", character.vertices.rows()},
          {"triangles", character.triangles.rows()},
          {"bounding_box_m", {box(0), box(1), box(2)}},
          {"clips", clips_info(file, character.skeleton, unit)},
          {"notes", character.notes},
          {"joints", joint_names(character.skeleton)}};
}

Json json_of_modifiers(const SkinModifiers& modifiers) {
  return transformed(modifiers.stack, [&](const SkinModifier& modifier) {
    return Json{{"name", modifier.name},
                {"type", modifier.type},
                {"on", modifier.on},
                {"constants", modifier.constants},
                {"components", modifier.component_count}};
  });
}

Json basis_info(const std::string& path) {
  const std::vector<Level> levels = load_levels(path);
  const Basis& basis = levels.front().basis;
  Json bytes = Json::object();
  for (const auto& [stage, size] : table_bytes(basis)) {
    bytes[stage] = static_cast<double>(size) / std::max(1u, basis.mesh.vertex_count());
  }
  Metadata metadata = basis.metadata;
  metadata.erase("curve");
  metadata.erase("levels");
  metadata.erase(trainer::kLearnedPoses);  // hashes
  Json result = {{"kind", "basis"},
                 {"vertices", basis.mesh.vertex_count()},
                 {"output_vertices", basis.mesh.output_count()},
                 {"fibres", basis.strain.fibre_count()},
                 {"regions", basis.residual.regions.size()},
                 {"coefficients", basis.residual.coefficient_count()},
                 {"kernel_centres", basis.residual.centre_count()},
                 {"controls", basis.residual.controls},
                 {"modifiers", json_of_modifiers(basis.modifiers)},
                 {"modifier_channels", modifier_channels(basis.modifiers)},
                 {"bytes_per_vertex", bytes},
                 {"joints", joint_names(basis.skeleton)},
                 {"metadata", metadata}};
  if (const Json table = levels_info(levels, trainer::read_proxy_report(basis)); !table.empty())
    result["levels"] = table;
  for (const TradeOffPoint& point : trainer::read_curve(basis)) result["curve"].push_back(to_json(point));
  if (const std::filesystem::path beside = attachments_beside(path); std::filesystem::exists(beside)) {
    result["attached"] = to_json(load_attachments(beside, basis, path).meshes);
  }
  return result;
}

// Facts of dynamics that need no basis.
Json dynamics_info(const std::string& path, const Safetensors& file) {
  const auto rows = [&](const char* name) {
    const auto found = file.tensors.find(name);
    if (found == file.tensors.end()) {
      throw Error(ErrorKind::file, path, ": tensor '", name, "' is missing: damaged dynamics");
    }
    if (found->second.shape.empty()) {
      throw Error(ErrorKind::file, path, ": tensor '", name,
                  "' is a single number, expected an array: damaged dynamics");
    }
    return found->second.shape.front();
  };
  Json result = {{"kind", "dynamics"},
                 {"tets", rows("tets.tets")},
                 {"nodes", rows("tets.nodes")},
                 {"surface_nodes", rows("tets.surface")},
                 {"vertices", rows("tets.skin")}};
  const JiggleStep step = read_step(file, path);
  result["frames_per_second"] = step.frames_per_second;
  result["substeps"] = step.substeps;
  result["integrator"] = step.implicit_euler ? "euler" : "tr-bdf2";
  std::map<std::string, std::size_t> bytes;
  for (const auto& [name, tensor] : file.tensors) bytes[name.substr(0, name.find('.'))] += tensor.bytes.size();
  result["bytes"] = bytes;
  Metadata metadata = file.metadata;
  // The trainer's metadata are JSON: the report's entries stand among the others.
  for (const char* own : {"report", "provenance"}) {
    const Json told = Json::parse(metadata[own], nullptr, false);
    if (!told.is_object()) throw Error(ErrorKind::file, path, ": its ", own, " is not a JSON object: damaged dynamics");
    metadata.erase(own);
    result.update(own == std::string("report") ? told : Json{{own, told}});
  }
  result["metadata"] = metadata;
  return result;
}

Json state_info(const std::string& path) {
  const StateFile file = read_state(path);
  return {{"kind", "state of the jiggle"},
          {"frame", file.state.frame},
          {"known", file.state.known},
          {"joints", file.state.joints.size() / 3},
          {"nodes", file.state.motion.nodes.size() / 3},
          {"dynamics", file.dynamics}};
}

Json attachments_info(const std::string& path) {
  const Attachments attachments = load_attachments(path);
  return {{"kind", "attached geometry"}, {"meshes", to_json(attachments.meshes)}, {"metadata", attachments.metadata}};
}

// A basis, dynamics, or attached geometry.
Json trained_info(const std::string& path) {
  const Safetensors file = read_safetensors(path);
  const auto found = file.metadata.find("schema");
  const std::string schema = found == file.metadata.end() ? "" : found->second;
  if (schema.starts_with("bodyopt-dynamics-")) return dynamics_info(path, file);
  if (schema.starts_with("bodyopt-attached-")) return attachments_info(path);
  return basis_info(path);
}

Json cache_info(const std::string& path) {
  const Pc2Reader reader(path);
  return {{"kind", "point cache"},
          {"points", reader.point_count()},
          {"samples", reader.sample_count()},
          {"start_frame", reader.start_frame()},
          {"sample_rate", reader.sample_rate()}};
}

Json nodes_info(const std::string& path) {
  const NodesReader reader(path);
  return {{"kind", "draft"},
          {"points", reader.point_count()},
          {"samples", reader.sample_count()},
          {"start_frame", reader.start_frame()},
          {"nodes", reader.node_count()},
          {"tets", reader.tets().rows()}};
}

Json dataset_info(const std::string& path) {
  const Dataset dataset = read_dataset(path);
  const Json takes = transformed(dataset.takes, [&](const DatasetTake& take) {
    return Json{{"name", take.name},
                {"clip", take.clip},
                {"frames", format_frame_range(take.frames)},
                {"heldout", format_frame_range(take.heldout)},
                {"shapes", take.shapes}};
  });
  return {{"kind", "dataset"},
          {"character", dataset.character},
          {"muscles", dataset.muscles},
          {"regions", dataset.regions},
          {"takes", takes}};
}

Json info(std::string path, double unit) {
  path = dataset_file(path).string();
  require_file(path);
  const std::string extension = lower_case_extension(path);
  if (is_called_scene(path)) return scene_info(path, unit);
  if (extension == ".safetensors") return trained_info(path);
  if (extension == ".state") return state_info(path);
  if (extension == ".pc2" || extension == ".mdd") return cache_info(path);
  if (extension == ".nodes") return nodes_info(path);
  if (extension == ".bvh") return bvh_info(path);
  if (extension == ".json") return dataset_info(path);
  throw Error(
      ErrorKind::file, path,
      ": expected .glb, .gltf, .vrm, .fbx, .bvh, .safetensors, .state, .pc2, .mdd, .nodes or dataset .json, found '",
      extension, "'", looks_like(path));
}

struct InfoArguments {
  std::string path;
  double unit = 0;
  JsonOption json;
};

void show(const InfoArguments& arguments) {
  const Json result = info(arguments.path, arguments.unit);
  arguments.json.emit(result, info_text(result));
}

}  // namespace

void add_info(CLI::App& app) {
  const auto [verb, arguments] = add_verb<InfoArguments>(app, "info", "Show what a file holds", show);
  add_required(verb, "file", arguments.path, "FILE",
               "Character, clip, basis, dynamics, attached geometry, state, point cache or dataset.json");
  add_unit(verb, arguments.unit);
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
