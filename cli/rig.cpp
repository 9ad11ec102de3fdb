// bodyopt rig: what a rig that nobody has prepared needs, to begin with and to edit.
#include <spdlog/spdlog.h>

#include <set>

#include "assets/joint_regions.h"
#include "assets/json_file.h"
#include "assets/notes.h"
#include "cli/arguments/common.h"
#include "cli/arguments/example_poses.h"
#include "dataset/regions_file.h"
#include "runtime/core/error.h"
#include "trainer/anatomy/carried_mapping.h"
#include "trainer/dynamics/build_dynamics.h"
#include "trainer/motion/first_limits.h"
#include "trainer/train/skinning/ddm_basis.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

struct RigArguments {
  std::string character, out, joint_map;
  double unit = 0;
  std::vector<std::string> clips, mappings;
  JsonOption json;
};

// Without any named, those in the character's own file.
std::vector<Pose> shown_poses(const RigArguments& arguments, const Skeleton& skeleton) {
  std::vector<std::string> sources = arguments.clips;
  if (sources.empty()) {
    for (const std::string& name : clip_names(arguments.character)) {
      sources.push_back(name.empty() ? arguments.character : arguments.character + "#" + name);
    }
  }
  return read_poses(sources, skeleton, arguments.unit, arguments.joint_map);
}

// What is chosen depends on the skin alone: few tets will do.
constexpr Eigen::Index kFewTets = 3000;

// What `dynamics` chooses for tissue without further word; null, with a warning, where it cannot fill the skin.
Json first_jiggle(const Character& character) {
  try {
    return chosen_jiggle(build_dynamics(character, {}, build_ddm_basis(character, {}), {.resolution = kFewTets}));
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::mismatch) throw;
    spdlog::warn("no jiggle.json: {}", error.what());
    return {};
  }
}

constexpr const char* kRegionSource =
    "skin weights, summed by joint: a joint that moves as much skin as 40 vertices, the fewest that train gives a "
    "region "
    "of its own, has one; the skin of others is with the nearest joint above that has one";

std::vector<std::string> write_mappings(const RigArguments& arguments, const Skeleton& skeleton) {
  std::vector<std::string> written;
  for (const std::string& path : arguments.mappings) {
    const anatomy::CarriedMapping mapping = anatomy::carried_mapping(path, skeleton);
    const fs::path out = fs::path(arguments.out) / fs::path(path).filename();
    write_json(mapping.json, out);
    written.push_back(out.string());
    if (mapping.unknown.empty()) continue;
    spdlog::warn("{}: the character has no joint that is known to be {}: write its own in their place", out.string(),
                 list_names(mapping.unknown));
  }
  return written;
}

// They are written to be edited: what was edited is not lost.
void refuse_existing(const RigArguments& arguments) {
  std::vector<std::string> names{"limits.json", "regions.json", "jiggle.json"};
  for (const std::string& path : arguments.mappings) names.push_back(fs::path(path).filename().string());
  std::set<std::string> seen;
  for (const std::string& name : names) {
    const fs::path out = fs::path(arguments.out) / name;
    if (!seen.insert(name).second) {
      throw Error(ErrorKind::usage, out.string() + ": two files would be written to it: rename a mapping");
    }
    if (fs::exists(out)) {
      throw Error(ErrorKind::usage,
                  out.string() + ": is there already, edited perhaps: remove it, or give another --out");
    }
  }
}

void run(const RigArguments& arguments) {
  arguments.json.require_writable();
  refuse_existing(arguments);
  const Character character = read_character(arguments.character, arguments.unit);
  say(character.notes);
  const Skeleton& skeleton = character.skeleton;
  const std::vector<Pose> poses = shown_poses(arguments, skeleton);
  const JointLimits limits = first_limits(character, poses);
  const std::vector<RegionWeights> regions = joint_regions(character);
  const Json jiggle = first_jiggle(character);

  make_folder(arguments.out);
  const fs::path out = arguments.out;
  std::vector<std::string> files = write_mappings(arguments, skeleton);
  write_joint_limits(limits, skeleton, out / "limits.json");
  write_regions(regions, character, out / "regions.json", kRegionSource);
  if (!jiggle.is_null()) write_json(jiggle, out / "jiggle.json");
  for (const char* name : {"limits.json", "regions.json"}) files.push_back((out / name).string());
  if (!jiggle.is_null()) files.push_back((out / "jiggle.json").string());
  const auto from_clips = std::count_if(limits.dofs.begin(), limits.dofs.end(), [](const DegreeOfFreedom& dof) {
    return dof.source.starts_with("what the clips");
  });
  arguments.json.emit({{"files", files},
                       {"frames", poses.size()},
                       {"degrees_of_freedom", limits.dofs.size()},
                       {"from_clips", from_clips},
                       {"regions", regions.size()}},
                      format("%zu degrees of freedom, %td from %zu frames of clips, the others by rule; %zu regions\n",
                             limits.dofs.size(), from_clips, poses.size(), regions.size()) +
                          "wrote " + list_names(files, files.size()) + "\n");
}

}  // namespace

void add_rig(CLI::App& app) {
  auto arguments = std::make_shared<RigArguments>();
  CLI::App& verb = *app.add_subcommand("rig", "First joint limits, jiggle settings and regions of a rig, to be edited");
  verb.add_option("character", arguments->character, "Character (.glb, .gltf)")->required()->type_name("CHARACTER");
  verb.add_option("--out", arguments->out, "Folder for limits.json, jiggle.json, regions.json")
      ->required()
      ->type_name("DIR")
      ->check(refuse_empty);
  verb.add_option("--clip", arguments->clips, "Clips that show how far joints go (default: the character's own)")
      ->type_name("CLIP");
  verb.add_option("--mapping", arguments->mappings,
                  "Mappings of muscles for another rig, to be written with this rig's joints")
      ->type_name("FILE");
  add_joint_map(verb, arguments->joint_map);
  add_unit(verb, arguments->unit);
  arguments->json.add(verb);
  verb.callback([arguments] { run(*arguments); });
}

}  // namespace bodyopt::cli
