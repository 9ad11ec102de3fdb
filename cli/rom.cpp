// bodyopt rom: a character and its joint limits to a clip that shows the whole range of motion.
#include <nlohmann/json.hpp>

#include "assets/clips/clip_source.h"
#include "cli/arguments/common.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "trainer/motion/attached_rig.h"
#include "trainer/motion/first_limits.h"
#include "trainer/motion/held_turns.h"
#include "trainer/motion/range_of_motion.h"

namespace bodyopt::cli {
namespace {

struct RomArguments {
  std::string character, limits, out;
  double unit = 0;
  ClipOptions clip;
  std::vector<std::string> from;
  trainer::RangeOfMotionOptions options;
  JsonOption json;
};

constexpr std::size_t kCoverageSamples = 1000;

// Poses that no body takes make a basis of such poses: what the clip holds beyond the limits is said.
void say_held_turns(const std::string& source, const std::vector<Pose>& poses, const trainer::JointLimits& limits,
                    const Skeleton& skeleton) {
  const std::vector<std::string> notes = transformed(
      trainer::held_turns(limits, skeleton, poses),
      [&](const trainer::HeldTurn& turn) { return source + ": " + describe(turn, skeleton, poses.size()); });
  say(notes);
}

// Limits are those of the file, or else what the clips show.
trainer::JointLimits limits_for(const RomArguments& arguments, const Character& character) {
  if (!arguments.limits.empty()) return trainer::read_joint_limits(arguments.limits, character.skeleton);
  if (arguments.from.empty()) {
    throw Error(ErrorKind::usage,
                "rom needs --limits, or clips to take them from (--from); 'bodyopt rig' writes first ones");
  }
  trainer::JointLimits limits =
      trainer::first_limits(character, read_poses(arguments.from, character.skeleton, arguments.unit, arguments.clip));
  const std::string detached = trainer::detached_text(limits.detached, character.skeleton);
  if (!detached.empty()) warn(detached);
  return limits;
}

// Poses on the rig whose limits they are.
std::vector<Pose> example_poses(const RomArguments& arguments, const trainer::JointLimits& limits,
                                const trainer::AttachedRig& rig, const Skeleton& skeleton) {
  std::vector<Pose> examples;
  for (const std::string& source : arguments.from) {
    const std::vector<Pose> poses = rig.attached(read_poses({source}, skeleton, arguments.unit, arguments.clip));
    say_held_turns(source, poses, limits, rig.skeleton());
    examples.insert(examples.end(), poses.begin(), poses.end());
  }
  return examples;
}

// The poses that the clip should show are those of the examples, or else any within the limits.
std::vector<Pose> wanted_poses(const Character& character, const trainer::JointLimits& limits,
                               const trainer::RangeOfMotionOptions& options) {
  if (!options.examples.empty()) return options.examples;
  return trainer::random_poses(limits, character.skeleton, trainer::overlap_of_limits(character, limits),
                               kCoverageSamples, options.seed + 1);
}

void say_few_frames(const RomArguments& arguments, const trainer::JointLimits& limits) {
  const std::size_t needed = trainer::frames_for_sweeps(limits);
  if (static_cast<std::size_t>(arguments.options.frames) >= needed) return;
  say(
      {format("{} frames are too few to sweep each of {} degrees of freedom from end to end by itself, which takes {}: "
              "random poses have to show the rest",
              arguments.options.frames, limits.dofs.size(), needed)});
}

std::string describe_wanted(const RomArguments& arguments, std::size_t count) {
  if (!arguments.from.empty()) return "degrees from the poses of the clips given to the nearest frame:\n";
  if (count == 0) {
    return "how much of the limits is shown was not measured: no random pose within them was found in which no limbs "
           "overlap; narrow those that reach through the body\n";
  }
  return format("degrees from {} random poses, in which no limbs overlap, to the nearest frame:\n", count);
}

void run(const RomArguments& arguments) {
  arguments.json.require_writable();
  refuse_overwriting(arguments.out, arguments.character);
  for (const std::string& clip : arguments.from) refuse_overwriting(arguments.out, split_source(clip).path);
  require_writable(arguments.out);
  const Character own = read_character(arguments.character, arguments.unit);
  say(own.notes);
  const trainer::JointLimits own_limits = limits_for(arguments, own);
  const trainer::AttachedRig rig(own.skeleton, own_limits.detached);
  const Character character = rig.attached(own);
  const trainer::JointLimits limits = rig.attached(own_limits);
  const Skeleton& skeleton = character.skeleton;
  trainer::RangeOfMotionOptions options = arguments.options;
  options.examples = example_poses(arguments, limits, rig, own.skeleton);

  const trainer::RangeOfMotion motion = trainer::range_of_motion(character, limits, options);
  const Clip clip = trainer::clip_of(motion, limits, skeleton);
  write_clip(rig.detached(clip), own.skeleton, own.unit, arguments.out);

  say_few_frames(arguments, limits);
  std::string text =
      format("{} frames: rest, {} of sweeps, {} of pairs, {} in which limbs touch, {} random\n", clip.poses.size(),
             motion.sweep_frames, motion.pair_frames, motion.touching_frames, motion.random_frames);
  text += format("the largest step from a frame to the next is {:.1f} degrees", motion.largest_step);
  text += options.step < trainer::RangeOfMotionOptions{}.step
              ? format(", of random frames {:.1f} at most\n", options.step)
              : "\n";
  const std::vector<Pose> wanted = wanted_poses(character, limits, options);
  text += describe_wanted(arguments, wanted.size());
  Json per_joint = Json::array();
  for (const trainer::JointCoverage& joint : trainer::coverage(clip.poses, wanted, character)) {
    if (wanted.empty()) break;
    text += format("  {:20} mean {:5.1f}  largest {:5.1f}\n", joint.joint, joint.mean, joint.largest);
    per_joint.push_back({{"joint", joint.joint}, {"mean_degrees", joint.mean}, {"largest_degrees", joint.largest}});
  }
  const std::vector<trainer::CoupledJoints> pairs = trainer::coupled_joints(skeleton, clip.poses);
  const Json coupled = transformed(pairs, [&](const trainer::CoupledJoints& pair) {
    return Json{{"joint", skeleton.joints[pair.joint].name},
                {"parent", skeleton.joints[pair.parent].name},
                {"correlation", pair.correlation}};
  });
  const std::string together = describe(pairs, skeleton);
  if (!together.empty()) say({together});
  text += "wrote " + arguments.out + "\n";
  arguments.json.emit({{"clip", arguments.out},
                       {"frames", clip.poses.size()},
                       {"sweep_frames", motion.sweep_frames},
                       {"pair_frames", motion.pair_frames},
                       {"touching_frames", motion.touching_frames},
                       {"random_frames", motion.random_frames},
                       {"step_degrees", options.step},
                       {"largest_step_degrees", motion.largest_step},
                       {"coupled_joints", coupled},
                       {"coverage", per_joint}},
                      text);
}

}  // namespace

void add_rom(CLI::App& app) {
  const auto [verb, arguments] = add_verb<RomArguments>(
      app, "rom", "Make a clip of a character's whole range of motion, to simulate and train on", run);
  add_required(verb, "character", arguments.character, "CHARACTER", "Character (.glb, .gltf, .fbx)");
  add_option(verb, "--limits", arguments.limits, "Joint limits (limits.json); default: what the clips of --from show")
      ->type_name("FILE");
  add_option(verb, "--out", arguments.out, "FILE.glb", "The clip to write")->required();
  add_number(verb, "--frames", arguments.options.frames, 1, 1000000,
             "How many frames to make (a number, where other verbs take a list of frames)");
  add_option(verb, "--seed", arguments.options.seed, "Another seed gives other random poses")->capture_default_str();
  add_option(verb, "--from", arguments.from,
             "Clips whose poses the random poses are blended from, beyond the limits if they go there")
      ->type_name("CLIP");
  add_option(verb, "--step", arguments.options.step,
             "Degrees that a joint may turn from a random frame to the next: for solvers that need a smooth motion")
      ->check(number_from(1, 360));
  add_retargeting(verb, arguments.clip.joint_map, arguments.clip.up);
  add_unit(verb, arguments.unit);
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
