#include "runtime/basis/skeleton.h"

#include <xxhash.h>

#include <cmath>

namespace bodyopt {

int Skeleton::find(const std::string& name) const {
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (joints[j].name == name) return static_cast<int>(j);
  }
  return -1;
}

std::uint64_t skeleton_hash(const Skeleton& skeleton) {
  std::string bytes;
  for (const Joint& joint : skeleton.joints) {
    bytes += joint.name + '\n' + std::to_string(joint.parent) + '\n';
    for (const auto& row : joint.inverse_bind.m) {
      for (const double x : row) bytes += std::to_string(std::llround(x * 1e5)) + ' ';
    }
  }
  return XXH3_64bits(bytes.data(), bytes.size());
}

int common_joint(const Skeleton& skeleton, std::uint32_t one, std::uint32_t other) {
  int a = static_cast<int>(one), b = static_cast<int>(other);
  while (a != b) {  // parents come before children: the later one is above nothing but what comes after it
    int& later = a > b ? a : b;
    later = skeleton.joints[static_cast<std::size_t>(later)].parent;
  }
  return a;
}

Pose bind_pose(const Skeleton& skeleton) {
  Pose pose;
  for (const Joint& joint : skeleton.joints) pose.joints.push_back(joint.bind);
  return pose;
}

Vec3 bind_place(const Skeleton& skeleton, std::size_t joint) {
  const Affine bind = inverse(skeleton.joints[joint].inverse_bind);
  return {bind.m[0][3], bind.m[1][3], bind.m[2][3]};
}

}  // namespace bodyopt
