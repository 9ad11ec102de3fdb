// bodyopt check: does a dataset belong together; is a character fit for use; does a clip suit a character.
#include "trainer/check/check.h"

#include <algorithm>
#include <filesystem>

#include "assets/notes.h"
#include "cli/arguments/common.h"
#include "runtime/core/error.h"
#include "trainer/motion/coupled_joints.h"
#include "trainer/motion/held_turns.h"

namespace bodyopt::cli {
namespace {

struct CheckArguments {
  std::string path, limits;
  ClipArguments clip;
  double unit = 0;
  JsonOption json;
};

void check_character(const CheckArguments& arguments) {
  const Character character = read_character(arguments.path, arguments.unit);
  const auto box = (character.vertices.colwise().maxCoeff() - character.vertices.colwise().minCoeff()).eval();
  const std::string surface = describe_surface(character);
  std::string text =
      format("%s: %u vertices, %td after welding seams, %zu joints, %.3f x %.3f x %.3f m\nsurface: %s\n",
             character.name.c_str(), character.output_count(), static_cast<std::ptrdiff_t>(character.vertices.rows()),
             character.skeleton.size(), box(0), box(1), box(2), surface.c_str());
  if (!surface.starts_with("closed")) text += "simulate puts such a skin in a coarse cage\n";
  for (const std::string& note : character.notes) text += "note: " + note + "\n";
  arguments.json.emit({{"vertices", character.output_count()},
                       {"welded_vertices", character.vertices.rows()},
                       {"joints", character.skeleton.size()},
                       {"bounding_box_m", {box(0), box(1), box(2)}},
                       {"surface", surface},
                       {"notes", character.notes}},
                      text);
}

// What the frames asked for hold beyond the character's limits.
Json held_beyond_limits(const std::string& path, const Skeleton& skeleton, const std::vector<Pose>& poses,
                        std::string& text) {
  const JointLimits limits = read_joint_limits(path, skeleton);
  Json held = Json::array();
  for (const HeldTurn& turn : held_turns(limits, skeleton, poses)) {
    const std::string description = describe(turn, skeleton, poses.size());
    text += "  PROBLEM: " + description + "\n";
    held.push_back({{"joint", skeleton.joints[turn.joint].name},
                    {"degrees", turn.degrees},
                    {"axis", turn.axis},
                    {"share_of_frames", turn.share},
                    {"problem", description}});
  }
  if (held.empty()) text += "no joint is held beyond its limits\n";
  const std::vector<std::string> unknown = turning_without_limits(limits, skeleton, poses);
  if (!unknown.empty()) text += "note: the limits say nothing of " + list_names(unknown) + ": not judged\n";
  return held;
}

// Reading it says how it suits the character; limits say whether it keeps to them.
void check_clip(const CheckArguments& arguments) {
  const Character character = read_character(arguments.path, arguments.unit);
  std::vector<int> frames;
  const Clip clip = arguments.clip.read(character.skeleton, arguments.unit, frames);
  std::string text = clip.name + ": " + count_of(frames.size(), "frame", "frames") + "\n";
  Json result = {{"clip", clip.name}, {"frames", frames.size()}, {"notes", clip.notes}};
  if (!arguments.limits.empty()) {
    result["held_beyond_limits"] =
        held_beyond_limits(arguments.limits, character.skeleton, poses_of(clip, frames), text);
  }
  arguments.json.emit(result, text);
}

// Joints that the frames to learn from do not tell apart.
std::string coupling_of(const Dataset& dataset) {
  const Skeleton skeleton = read_character(dataset.folder / dataset.character, dataset.unit).skeleton;
  std::vector<Pose> poses;
  for (const DatasetTake& take : dataset.takes) {
    std::vector<int> learned = take.frames;
    std::erase_if(learned, [&](int frame) {
      return std::find(take.heldout.begin(), take.heldout.end(), frame) != take.heldout.end();
    });
    for (Pose& pose : poses_of(read_clip(dataset, take, skeleton), learned)) poses.push_back(std::move(pose));
  }
  return describe(coupled_joints(skeleton, poses), skeleton);
}

void check(const CheckArguments& arguments) {
  std::filesystem::path path = arguments.path;
  if (std::filesystem::is_directory(path)) path /= "dataset.json";
  const Dataset dataset = read_dataset(path);
  const std::vector<TakeCheck> takes = check_dataset(dataset);
  const std::string mismatch = first_problem(takes, path);
  Json result = Json::array();
  std::string text;
  for (const TakeCheck& take : takes) {
    text += format(
        "%s: %u points, %u samples, %.2f mm RMS from the skinned character (frame %d, nearest to the bind "
        "pose: %.2f mm)\n",
        take.name.c_str(), take.points, take.samples, take.fit_mm, take.rest_frame, take.rest_fit_mm);
    for (const std::string& problem : take.problems) text += "  PROBLEM: " + problem + "\n";
    result.push_back({{"name", take.name},
                      {"points", take.points},
                      {"samples", take.samples},
                      {"fit_mm", take.fit_mm},
                      {"rest_fit_mm", take.rest_fit_mm},
                      {"problems", take.problems}});
  }
  if (mismatch.empty()) {
    const std::string coupled = coupling_of(dataset);
    if (!coupled.empty()) text += "note: " + coupled + "\n";
  }
  text += mismatch.empty() ? "it belongs together\n" : "it does not belong together\n";
  arguments.json.emit({{"takes", result}, {"belongs_together", mismatch.empty()}}, text);
  if (!mismatch.empty()) throw Error(ErrorKind::mismatch, mismatch);
}

void run(const CheckArguments& arguments) {
  arguments.json.require_writable();
  const std::string extension = std::filesystem::path(arguments.path).extension();
  const bool is_character = extension == ".glb" || extension == ".gltf";
  if (!arguments.clip.source.empty()) {
    if (!is_character) throw Error(ErrorKind::usage, "--clip is checked with a character (.glb, .gltf), not a dataset");
    return check_clip(arguments);
  }
  if (is_character) return check_character(arguments);
  check(arguments);
}

}  // namespace

void add_check(CLI::App& app) {
  auto arguments = std::make_shared<CheckArguments>();
  CLI::App& verb =
      *app.add_subcommand("check", "Does a dataset belong together? Is a character fit for use? Does a clip suit it?");
  verb.add_option("dataset", arguments->path, "dataset.json or its folder, or a character (.glb, .gltf)")
      ->required()
      ->type_name("DATASET");
  arguments->clip.add(verb);
  CLI::Option& clip = *verb.get_option("--clip")->required(false);
  verb.add_option("--limits", arguments->limits, "Joint limits (limits.json): does the clip hold joints beyond them?")
      ->type_name("FILE")
      ->check(refuse_empty)
      ->needs(&clip);
  for (const char* of_clip : {"--frames", "--fps", "--first-frame", "--controls", "--joint-map"}) {
    verb.get_option(of_clip)->needs(&clip);
  }
  add_unit(verb, arguments->unit);
  arguments->json.add(verb);
  verb.callback([arguments] { run(*arguments); });
}

}  // namespace bodyopt::cli
