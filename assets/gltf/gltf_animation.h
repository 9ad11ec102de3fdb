// The channels of a glTF animation and their interpolation.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "assets/gltf/gltf_file.h"

namespace bodyopt {

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

}  // namespace bodyopt
