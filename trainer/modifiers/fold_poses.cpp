#include "trainer/modifiers/fold_poses.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/modifiers/joint_turns.h"

namespace bodyopt {
namespace {

constexpr int kDirections = 12;
constexpr std::size_t kMostSteps = 3;

Vec3 bind_place(const Joint& joint) {
  const Affine bind = inverse(joint.inverse_bind);
  return {bind.m[0][3], bind.m[1][3], bind.m[2][3]};
}

// From a joint to the middle of those that follow it, or, of the last of a chain, on from its parent. Rest space; may
// be zero.
Vec3 bone_of(const Skeleton& skeleton, std::uint32_t joint) {
  const Vec3 own = bind_place(skeleton.joints[joint]);
  Vec3 bone{0, 0, 0};
  double children = 0;
  for (const Joint& other : skeleton.joints) {
    if (other.parent != static_cast<int>(joint)) continue;
    bone = bone + (bind_place(other) - own);
    ++children;
  }
  const int parent = skeleton.joints[joint].parent;
  if (children > 0) return (1 / children) * bone;
  return parent < 0 ? bone : own - bind_place(skeleton.joints[static_cast<std::size_t>(parent)]);
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

std::vector<FoldDirection> fold_directions(const Skeleton& skeleton, std::uint32_t joint, double first) {
  const Vec3 bone = bone_of(skeleton, joint);
  if (skeleton.joints[joint].parent < 0 || !(length(bone) > 1e-6)) return {};
  std::vector<FoldDirection> directions;
  for (int k = 0; k < kDirections; ++k) {
    const double around = (first + 360.0 * k / kDirections) * std::numbers::pi / 180;
    directions.push_back({joint, rotate(axis_angle((1 / length(bone)) * bone, around), across(bone))});
  }
  return directions;
}

Pose bent_pose(const Skeleton& skeleton, const FoldDirection& direction, double degrees) {
  const Quat parent = bind_world_rotations(skeleton)[static_cast<std::size_t>(skeleton.joints[direction.joint].parent)];
  const Quat turn = axis_angle(direction.axis, degrees * std::numbers::pi / 180);  // in rest space
  Pose pose = bind_pose(skeleton);
  Quat& rotation = pose.joints[direction.joint].rotation;
  rotation = conjugate(parent) * turn * parent * rotation;
  return pose;
}

std::vector<std::uint32_t> folding_joints(const Basis& basis, const Eigen::VectorXd& thickness) {
  std::vector<double> sum(basis.skeleton.size(), 0), count(basis.skeleton.size(), 0);
  for (std::uint32_t v = 0; v < basis.mesh.vertex_count(); ++v) {
    sum[basis.ddm.vertices[v].base_joint] += thickness[v];
    count[basis.ddm.vertices[v].base_joint] += 1;
  }
  std::vector<std::uint32_t> joints;
  for (std::uint32_t joint = 0; joint < basis.skeleton.size(); ++joint) {
    if (count[joint] * length(bone_of(basis.skeleton, joint)) > sum[joint]) joints.push_back(joint);
  }
  return joints;
}

bool goes_through(const std::vector<BuriedVertex>& buried, const Eigen::VectorXd& thickness) {
  const auto too_deep = [&](const BuriedVertex& vertex) { return vertex.depth > 0.3 * thickness[vertex.vertex]; };
  return 10 * std::ranges::count_if(buried, too_deep) > std::ssize(buried);
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
