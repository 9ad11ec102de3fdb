// bodyopt rig: what a rig that nobody has prepared needs, to begin with and to edit.
#include <spdlog/spdlog.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "assets/characters/joints_with_skin.h"
#include "base/json_file.h"
#include "base/wording.h"
#include "base/written_over.h"
#include "cli/arguments/common.h"
#include "dataset/regions_file.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "trainer/dynamics/build_dynamics.h"
#include "trainer/motion/attached_rig.h"
#include "trainer/motion/first_limits.h"
#include "trainer/muscle_models/mapping.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::cli {
namespace {

namespace muscle_models = trainer::muscle_models;
namespace fs = std::filesystem;

struct RigArguments {
  std::string character, out;
  double unit = 0;
  ClipOptions clip;
  std::vector<std::string> clips, mappings;
  JsonOption json;
};

// Clips are the named ones, or else those in the character's own file.
std::vector<Pose> shown_poses(const RigArguments& arguments, const Skeleton& skeleton) {
  std::vector<std::string> sources = arguments.clips;
  if (sources.empty()) {
    for (const std::string& name : clip_names(arguments.character)) {
      sources.push_back(name.empty() ? arguments.character : arguments.character + "#" + name);
    }
  }
  return read_poses(sources, skeleton, arguments.unit, arguments.clip);
}

// The choice depends on the skin alone: few tets will do.
constexpr Eigen::Index kFewTets = 3000;

// The defaults of `dynamics` for tissue; null, with a warning, where it cannot fill the skin.
Json first_jiggle(const Character& character) {
  try {
    return trainer::jiggle_json(
        trainer::build_dynamics(character, {}, trainer::build_ddm_basis(character, {}), {.resolution = kFewTets})
            .settings);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::mismatch) throw;
    spdlog::warn("no jiggle.json: {}", error.what());
    return {};
  }
}

constexpr const char* kRegionSource =
    "skin weights, summed by joint: a joint that moves as much skin as 40 vertices, the fewest that train gives a "
    "region of its own, has one; the skin of others is with the nearest joint above that has one";

struct RigFile {
  fs::path path;
  std::string text;
};

// The mappings that are named. Without any, they are those of people, as far as the joints' names tell what they are.
std::vector<muscle_models::CarriedMapping> mappings_of(const RigArguments& arguments, const Skeleton& skeleton) {
  std::vector<muscle_models::CarriedMapping> mappings;
  for (const std::string& path : arguments.mappings) mappings.push_back(muscle_models::carried_mapping(path, skeleton));
  if (!mappings.empty()) return mappings;
  mappings = muscle_models::first_mappings(skeleton);
  if (mappings.empty()) {
    spdlog::warn(
        "no mapping of muscles: too few joints have names that tell which is a thigh or an upper arm of a person "
        "(write one, or give that of another rig: --mapping)");
  }
  return mappings;
}

void add_mappings(const RigArguments& arguments, const Skeleton& skeleton, std::vector<RigFile>& files) {
  for (const muscle_models::CarriedMapping& mapping : mappings_of(arguments, skeleton)) {
    const fs::path out = fs::path(arguments.out) / mapping.name;
    files.push_back({out, bodyopt::text_of(mapping.json, out)});
    for (const muscle_models::UnplacedSegment& unplaced : mapping.unplaced) {
      spdlog::warn(
          "{}: the first two centres of the segment '{}' go to the joints '{}' and '{}', which are at the same place: "
          "write two that are apart, or 'muscles import' refuses it",
          out.string(), unplaced.segment, unplaced.joints[0], unplaced.joints[1]);
    }
    if (mapping.unknown.empty()) continue;
    spdlog::warn("{}: the character has no joint that is known to be {}: write its own in their place", out.string(),
                 list_names(mapping.unknown));
  }
}

void require_distinct(const std::vector<RigFile>& files) {
  std::set<fs::path> seen;
  for (const RigFile& file : files) {
    if (seen.insert(file.path).second) continue;
    throw Error(ErrorKind::usage, file.path, ": two files would be written to it: rename a mapping");
  }
}

bool is_there(const RigFile& file) {
  std::ifstream stream(file.path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(stream), {}) == file.text;
}

// They are written to be edited: what was edited is not lost. The same file, left by an interrupted run, is no edit.
void require_unedited(const std::vector<RigFile>& files) {
  for (const RigFile& file : files) {
    if (!fs::exists(file.path) || is_there(file)) continue;
    throw Error(ErrorKind::usage, file.path,
                ": is there already, edited perhaps: remove it, or give "
                "another --out");
  }
}

void write_new(const std::vector<RigFile>& files) {
  require_unedited(files);
  for (const RigFile& file : files) {
    if (!fs::exists(file.path)) write_file_atomically(file.path, std::as_bytes(std::span(file.text)));
  }
}

void run(const RigArguments& arguments) {
  arguments.json.require_writable();
  require_writable_folder(arguments.out);
  const Character character = read_character(arguments.character, arguments.unit);
  say(character.notes);
  const Skeleton& skeleton = character.skeleton;
  const std::vector<Pose> poses = shown_poses(arguments, skeleton);
  const trainer::JointLimits limits = trainer::first_limits(character, poses);
  const std::string detached = trainer::detached_text(limits.detached, skeleton);
  if (!detached.empty()) say({detached});
  const std::vector<RegionWeights> regions = joint_regions(character);

  const fs::path out = arguments.out;
  std::vector<RigFile> files;
  add_mappings(arguments, skeleton, files);
  files.push_back({out / "limits.json", bodyopt::text_of(trainer::to_json(limits, skeleton), out / "limits.json")});
  files.push_back({out / "regions.json", regions_text(regions, character, kRegionSource)});
  require_unedited(files);  // before what takes long
  const Json jiggle = first_jiggle(character);
  if (!jiggle.is_null()) files.push_back({out / "jiggle.json", bodyopt::text_of(jiggle, out / "jiggle.json")});
  require_distinct(files);
  make_folder(arguments.out);
  write_new(files);
  const std::vector<std::string> names = transformed(files, [&](const RigFile& file) { return file.path.string(); });
  const auto from_clips = std::ranges::count_if(
      limits.dofs, [](const trainer::DegreeOfFreedom& dof) { return dof.source.starts_with("what the clips"); });
  arguments.json.emit({{"files", names},
                       {"frames", poses.size()},
                       {"degrees_of_freedom", limits.dofs.size()},
                       {"from_clips", from_clips},
                       {"regions", regions.size()}},
                      format("{} degrees of freedom, {} from {} frames of clips, the others by rule; {} regions\n",
                             limits.dofs.size(), from_clips, poses.size(), regions.size()) +
                          "wrote " + list_names(names, names.size()) + "\n");
}

}  // namespace

void add_rig(CLI::App& app) {
  const auto [verb, arguments] = add_verb<RigArguments>(
      app, "rig", "Write first joint limits, jiggle settings and regions of a rig, to be edited", run);
  add_required(verb, "character", arguments.character, "CHARACTER", "Character (.glb, .gltf, .fbx)");
  add_option(verb, "--out", arguments.out, "DIR",
             "Folder for limits.json, jiggle.json, regions.json and mappings of muscles")
      ->required();
  add_option(verb, "--clip", arguments.clips, "Clips that show how far joints go (default: the character's own)")
      ->type_name("CLIP");
  add_option(verb, "--mapping", arguments.mappings,
             "Mappings of muscles for another rig, to be written with this rig's joints (default: those of a "
             "person's legs, trunk and arms)")
      ->type_name("FILE");
  add_retargeting(verb, arguments.clip.joint_map, arguments.clip.up);
  add_unit(verb, arguments.unit);
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
