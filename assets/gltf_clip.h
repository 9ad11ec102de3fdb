// Clips from glTF animations.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "assets/clip.h"
#include "assets/gltf_file.h"

namespace bodyopt {

// The channels of a glTF animation and their interpolation.

enum class ChannelPath { translation, rotation, scale };
enum class Interpolation { step, linear, cubic };

struct AnimationChannel {
  std::size_t node = 0;
  ChannelPath path = ChannelPath::translation;
  Interpolation interpolation = Interpolation::linear;
  std::vector<double> times;   // K, seconds, not decreasing
  std::vector<double> values;  // K x 3 or 4; for cubic K x 3 (in-tangent, value, out-tangent) x 3 or 4

  // The value at `seconds`, held before the first and after the last key. Rotations are of unit length (x, y, z, w);
  // for the others the fourth number is 0. Interpolation as in glTF 2.0, appendix C.
  std::array<double, 4> sample(double seconds) const;
};

// Morph weights are left out with a note. Throws Error(file): nodes or samplers out of range, keys that do not fit,
// decreasing times, the same property animated twice.
std::vector<AnimationChannel> read_channels(const GltfFile& file, std::size_t animation,
                                            std::vector<std::string>& notes);

// `name`: the animation; empty takes the first. Joints are matched as match_joints() says. If the file's rest pose
// (read_rest()) is the bind pose, or has the same bones, the nodes' local transforms are applied as they are. Joints
// that the clip does not animate then keep the skeleton's default. Otherwise Retarget transfers the motion, and its
// travel is scaled by the bones. Nodes above a joint that are no joints are composed in, as for characters, but for a
// scale of all joints. The unit is file_unit()'s, or, where bones at rest are then 8 times the character's or an
// eighth, theirs.
Clip read_gltf_clip(const GltfFile& file, const std::string& name, const SkeletonChoice& choose,
                    const ClipOptions& options);

// Like clip_keys(), for a clip that read_gltf_clip() reads.
std::vector<int> read_gltf_keys(const std::filesystem::path& path, const std::string& name, const ClipOptions& options);

// Cameras of a glTF file, as its nodes move them.

// `unit`: metres per file unit; `world_at(k)`: per node, from its space to the world at frame k of `frames`, metres.
// What is no camera as glTF has it is left out with a note.
std::vector<ClipCamera> read_gltf_cameras(const GltfFile& file, double unit, std::size_t frames,
                                          const std::function<std::vector<Affine>(std::size_t)>& world_at,
                                          std::vector<std::string>& notes);

}  // namespace bodyopt
