#include "trainer/modifiers/fold_poses.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/host/rig.h"

namespace bodyopt {
namespace {

constexpr int kDirections = 6;
constexpr std::size_t kMostSteps = 3;

Vec3 bind_place(const Joint& joint) {
  const Affine bind = inverse(joint.inverse_bind);
  return {bind.m[0][3], bind.m[1][3], bind.m[2][3]};
}

// From a joint to those that follow it, or, of the last of a chain, on from its parent. Rest space; may be zero.
Vec3 bone_of(const Skeleton& skeleton, std::uint32_t joint) {
  const Vec3 own = bind_place(skeleton.joints[joint]);
  Vec3 bone{0, 0, 0};
  for (const Joint& other : skeleton.joints) {
    if (other.parent == static_cast<int>(joint)) bone = bone + (bind_place(other) - own);
  }
  const int parent = skeleton.joints[joint].parent;
  if (!(length(bone) > 1e-6) && parent >= 0) {
    bone = own - bind_place(skeleton.joints[static_cast<std::size_t>(parent)]);
  }
  return bone;
}

// Any one at right angles to a vector that is not zero; unit.
Vec3 across(const Vec3& v) {
  const Vec3 other = std::abs(v[0]) < 0.7 * length(v) ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 normal = cross(v, other);
  return (1 / length(normal)) * normal;
}

// A joint and those above it, up to the root.
std::vector<std::uint32_t> chain_of(const Skeleton& skeleton, std::uint32_t joint) {
  std::vector<std::uint32_t> chain;
  for (int j = static_cast<int>(joint); j >= 0; j = skeleton.joints[static_cast<std::size_t>(j)].parent) {
    chain.push_back(static_cast<std::uint32_t>(j));
  }
  return chain;
}

}  // namespace

std::vector<Pose> bent_poses(const Skeleton& skeleton, std::uint32_t joint, const FoldBends& bends) {
  const Vec3 bone = bone_of(skeleton, joint);
  if (skeleton.joints[joint].parent < 0 || !(length(bone) > 1e-6)) return {};
  const Quat parent = bind_rotations(skeleton)[static_cast<std::size_t>(skeleton.joints[joint].parent)];
  std::vector<Pose> poses;
  for (int k = 0; k < kDirections; ++k) {
    const double around = bends.first_direction + 360.0 * k / kDirections;
    const Vec3 axis = rotate(axis_angle((1 / length(bone)) * bone, around * std::numbers::pi / 180), across(bone));
    for (const double angle : bends.angles) {
      const Quat turn = axis_angle(axis, angle * std::numbers::pi / 180);  // in rest space
      Pose pose = bind_pose(skeleton);
      Quat& rotation = pose.joints[joint].rotation;
      rotation = conjugate(parent) * turn * parent * rotation;
      poses.push_back(std::move(pose));
    }
  }
  return poses;
}

std::vector<std::uint32_t> joints_between(const Skeleton& skeleton, std::uint32_t from, std::uint32_t to) {
  std::vector<std::uint32_t> one = chain_of(skeleton, from), other = chain_of(skeleton, to);
  while (!one.empty() && !other.empty() && one.back() == other.back()) {
    one.pop_back();
    other.pop_back();
  }
  one.insert(one.end(), other.begin(), other.end());
  return one;
}

std::vector<std::uint32_t> triangles_near(const Basis& basis, std::uint32_t joint) {
  std::vector<char> near(basis.skeleton.size());
  for (std::uint32_t j = 0; j < near.size(); ++j)
    near[j] = joints_between(basis.skeleton, j, joint).size() <= kMostSteps;
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t t = 0; t < basis.mesh.triangles.size() / 3; ++t) {
    bool all = true;
    for (std::size_t k = 0; k < 3; ++k) {
      all = all && near[basis.ddm.vertices[basis.mesh.triangles[3 * std::size_t{t} + k]].base_joint];
    }
    if (all) triangles.push_back(t);
  }
  return triangles;
}

}  // namespace bodyopt
