// Biovision hierarchies: joints with offsets and channels, then one line of channel values per frame.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runtime/core/transform.h"

namespace bodyopt {

enum class BvhChannel : std::uint8_t { x_position, y_position, z_position, x_rotation, y_rotation, z_rotation };

struct BvhJoint {
  std::string name;
  int parent = -1;
  Vec3 offset{0, 0, 0};  // from the parent, file units
  std::vector<BvhChannel> channels;
  std::size_t first_channel = 0;  // of the joint's values in a frame

  bool has_position() const;
};

// Parents come before children; end sites are left out. At rest every rotation is the identity.
struct Bvh {
  std::vector<BvhJoint> joints;
  double frame_time = 0;  // seconds
  std::size_t frame_count = 0, channel_count = 0;
  std::vector<double> values;      // frames x channels; file units and degrees
  std::vector<std::string> notes;  // where the file is not as it says

  double duration() const { return frame_time * static_cast<double>(frame_count - 1); }
  // The joint's transform relative to its parent. Rotations apply in the order written, the first outermost; position
  // channels stand in place of the offset's coordinates.
  JointTransform local(std::size_t joint, std::size_t frame) const;
  // Between frames: slerp and lerp. Held after the last frame.
  JointTransform local_at(std::size_t joint, double seconds) const;
};

// UTF-8 or UTF-16. As many frames as are declared, or else as there are values for. Throws Error(file) with the
// line for anything that is not a BVH file of finite numbers and whole frames.
Bvh read_bvh(const std::filesystem::path& path);
// Parses a file's text; errors call it `path`.
Bvh parse_bvh(std::string text, const std::filesystem::path& path);

}  // namespace bodyopt
