#include "trainer/builtin/arm.h"

#include <string>

#include "assets/clips/gltf_clip.h"
#include "runtime/core/error.h"
#include "runtime/host/rig.h"

// Declares `name` and `name_end`, between which the assembler puts the bytes of a file of rigs/arm.
#define BODYOPT_ARM_FILE(name, file)                                                                    \
  extern "C" const char name[], name##_end[];                                                           \
  asm(".pushsection .rodata\n.hidden " #name ", " #name "_end\n.globl " #name ", " #name "_end\n" #name \
      ":\n.incbin \"" BODYOPT_ARM_FOLDER "/" file "\"\n" #name "_end:\n.popsection")

BODYOPT_ARM_FILE(bodyopt_arm_glb, "arm.glb");
BODYOPT_ARM_FILE(bodyopt_stocky_glb, "stocky.glb");
BODYOPT_ARM_FILE(bodyopt_arm_muscles, "muscles.json");
BODYOPT_ARM_FILE(bodyopt_arm_limits, "limits.json");

namespace bodyopt::trainer {
namespace {

constexpr double kFps = 24;

GltfFile arm_file() { return GltfFile("arm.glb", {bodyopt_arm_glb, bodyopt_arm_glb_end}); }

// In their bind pose, and more exactly than the file's inverse bind matrices say, which are in single precision.
void bind_as_the_nodes_stand(Skeleton& skeleton) {
  for (Joint& joint : skeleton.joints) joint.bind = joint.default_local;
  const std::vector<Affine> world = posed_joints(skeleton, bind_pose(skeleton).joints);
  for (std::size_t j = 0; j < skeleton.size(); ++j) skeleton.joints[j].inverse_bind = inverse(world[j]);
}

// As many frames a second of the file's motion are taken as `rate` says, and then played at 24 a second.
Clip arm_clip(const Skeleton& skeleton, const std::string& name, double rate) {
  const auto choose = [&](const std::set<std::string>&) { return skeleton; };
  Clip clip = read_gltf_clip(arm_file(), name, choose, {.fps = rate});
  clip.fps = kFps;
  return clip;
}

}  // namespace

BuiltinArm build_arm() {
  Character character = read_character(arm_file());
  bind_as_the_nodes_stand(character.skeleton);
  std::vector<Muscle> muscles =
      parse_muscles({bodyopt_arm_muscles, bodyopt_arm_muscles_end}, "muscles.json", character.skeleton);
  return {std::move(character), std::move(muscles)};
}

Character build_stocky_arm() {
  return read_character(GltfFile("stocky.glb", {bodyopt_stocky_glb, bodyopt_stocky_glb_end}));
}

JointLimits arm_limits(const Skeleton& skeleton) {
  return parse_joint_limits({bodyopt_arm_limits, bodyopt_arm_limits_end}, "limits.json", skeleton);
}

Clip arm_heldout(const Skeleton& skeleton, int frame_count) {
  if (frame_count < 1 || frame_count > kArmHeldoutFrames) {
    throw Error(ErrorKind::usage, "the arm's held-out motion has 1 to " + std::to_string(kArmHeldoutFrames) +
                                      " frames, not " + std::to_string(frame_count));
  }
  return arm_clip(skeleton, "heldout", kFps * frame_count / kArmHeldoutFrames);
}

Clip arm_stop(const Skeleton& skeleton) { return arm_clip(skeleton, "stop", kFps); }

}  // namespace bodyopt::trainer
