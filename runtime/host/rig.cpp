#include "runtime/host/rig.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "runtime/core/error.h"
#include "runtime/core/transformed.h"

namespace bodyopt {

std::vector<Affine> posed_joints(const Skeleton& skeleton, std::span<const JointTransform> local,
                                 std::vector<Affine> world) {
  world.resize(skeleton.size());
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    const Affine own = affine_from(local[j]);
    world[j] = parent < 0 ? own : world[static_cast<std::size_t>(parent)] * own;
  }
  return world;
}

std::vector<Affine> skinning_matrices(const Skeleton& skeleton, std::span<const JointTransform> local) {
  std::vector<Affine> matrices = posed_joints(skeleton, local);
  for (std::size_t j = 0; j < skeleton.size(); ++j) matrices[j] = matrices[j] * skeleton.joints[j].inverse_bind;
  return matrices;
}

namespace {

// The largest number of its linear part.
double linear_size(const Affine& a) {
  double size = 0;
  for (const auto& row : a.m) size = std::max({size, std::abs(row[0]), std::abs(row[1]), std::abs(row[2])});
  return size;
}

Affine difference(const Affine& a, const Affine& b) {
  Affine result;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 4; ++k) result.m[i][k] = a.m[i][k] - b.m[i][k];
  }
  return result;
}

void require_finite(const Affine& matrix, const Joint& joint) {
  double sum = 0;
  for (const auto& row : matrix.m) {
    for (const double x : row) sum += std::abs(x);
  }
  if (sum < 1e12) return;
  throw Error(ErrorKind::mismatch, "the skinning matrix of joint '", joint.name, "' is not of finite numbers");
}

}  // namespace

JointTransform local_joint(const Skeleton& skeleton, std::size_t j, const Affine& skinning, const Affine& of_parent) {
  constexpr double kMostShear = 1e-3;  // of the joint's scale: beyond what rounding to single precision makes
  const Joint& joint = skeleton.joints[j];
  require_finite(skinning, joint);
  Affine local = skinning * inverse(joint.inverse_bind);
  if (joint.parent >= 0) {
    local = inverse(of_parent * inverse(skeleton.joints[static_cast<std::size_t>(joint.parent)].inverse_bind)) * local;
  }
  const JointTransform transform = decompose(local);
  const double size = linear_size(local), shear = linear_size(difference(local, affine_from(transform)));
  if (shear <= kMostShear * size && size > 0) return transform;
  throw Error(ErrorKind::mismatch, "the skinning matrix of joint '", joint.name,
              "' is no rotation and scale of the joint's own axes against its parent: it is sheared, or scaled by 0");
}

std::vector<JointFeatures> joint_features_of(const Skeleton& skeleton) {
  if (!skeleton.features.empty()) return skeleton.features;
  std::vector<JointFeatures> features;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    if (parent >= 0) features.push_back({static_cast<std::uint32_t>(j), static_cast<std::uint32_t>(parent)});
  }
  return features;
}

std::vector<std::uint32_t> feature_joints(const Skeleton& skeleton) {
  return transformed(joint_features_of(skeleton), &JointFeatures::joint);
}

std::uint32_t joint_feature_count(const Skeleton& skeleton) {
  return 9 * static_cast<std::uint32_t>(joint_features_of(skeleton).size());
}

namespace {

void check_joints(const Skeleton& skeleton, const std::vector<JointTransform>& joints) {
  if (joints.size() != skeleton.size()) {
    throw Error(ErrorKind::mismatch, "a pose of ", joints.size(), " joints was given to a skeleton of ",
                skeleton.size(), ": it was made for another skeleton");
  }
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const JointTransform& t = joints[j];
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) sum += std::abs(t.translation[i]) + std::abs(t.scale[i]);
    for (const double x : t.rotation) sum += std::abs(x);
    if (!(sum < 1e12)) {
      throw Error(ErrorKind::mismatch, "the pose of joint '", skeleton.joints[j].name, "' is not a finite number");
    }
    if (!has_length(t.rotation)) {
      throw Error(ErrorKind::mismatch, "the rotation of joint '", skeleton.joints[j].name,
                  "' has the length 0: expected a quaternion x y z w");
    }
  }
}

// Rotation of a joint relative to its parent, away from the bind pose, in rest axes.
Quat turn_of(const Skeleton& skeleton, const std::vector<Quat>& bind, const std::vector<JointTransform>& joints,
             std::size_t j) {
  const Joint& joint = skeleton.joints[j];
  const Quat& axes = bind[static_cast<std::size_t>(joint.parent)];
  const Quat change = normalized(joints[j].rotation) * conjugate(normalized(joint.bind.rotation));
  return normalized(axes * change * conjugate(axes));
}

// Rotation of a joint relative to one above it, away from the bind pose, in rest axes.
Quat turn_below(int above, std::uint32_t joint, const Skeleton& skeleton, const std::vector<Quat>& bind,
                const std::vector<JointTransform>& joints) {
  Quat relative{0, 0, 0, 1};
  for (int j = static_cast<int>(joint); j != above; j = skeleton.joints[static_cast<std::size_t>(j)].parent) {
    relative = turn_of(skeleton, bind, joints, static_cast<std::size_t>(j)) * relative;
  }
  return relative;
}

// R of JointFeatures.
Quat rotation_of(const JointFeatures& of, const Skeleton& skeleton, const std::vector<Quat>& bind,
                 const std::vector<JointTransform>& joints) {
  if (of.joint == of.above) return {0, 0, 0, 1};
  const int common = common_joint(skeleton, of.joint, of.above);
  const Quat above = turn_below(common, of.above, skeleton, bind, joints),
             own = turn_below(common, of.joint, skeleton, bind, joints);
  return of.above_turn * conjugate(above) * own * conjugate(of.own_turn);
}

// A joint in the space of one above it.
Affine transform_below(int above, std::uint32_t joint, const Skeleton& skeleton,
                       const std::vector<JointTransform>& joints) {
  Affine relative;
  for (int j = static_cast<int>(joint); j != above; j = skeleton.joints[static_cast<std::size_t>(j)].parent) {
    relative = affine_from(joints[static_cast<std::size_t>(j)]) * relative;
  }
  return relative;
}

// The slide of the joint of JointFeatures, metres, turned as its axes are.
Vec3 slide_of(const JointFeatures& of, const Skeleton& skeleton, const std::vector<JointTransform>& joints) {
  if (of.joint == of.above) return {0, 0, 0};
  const int common = common_joint(skeleton, of.joint, of.above);
  const Affine seen = inverse(transform_below(common, of.above, skeleton, joints)) *
                      transform_below(common, of.joint, skeleton, joints);
  const Vec3 place = inverse(skeleton.joints[of.above].inverse_bind) * Vec3{seen.m[0][3], seen.m[1][3], seen.m[2][3]};
  return rotate(of.above_turn, place - bind_place(skeleton, of.joint));
}

}  // namespace

std::vector<Quat> bind_rotations(const Skeleton& skeleton) {
  std::vector<Quat> world;
  for (const Joint& joint : skeleton.joints) {
    const Quat own = normalized(joint.bind.rotation);
    world.push_back(joint.parent < 0 ? own : world[static_cast<std::size_t>(joint.parent)] * own);
  }
  return world;
}

namespace {

// J x 12.
void relative_skinning(const Skeleton& skeleton, const std::vector<Affine>& world, const float (&origin)[3],
                       std::vector<float>& skinning) {
  skinning.clear();
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    Affine relative = world[j];
    for (int i = 0; i < 3; ++i) relative.m[i][3] -= static_cast<double>(origin[i]);
    relative = relative * skeleton.joints[j].inverse_bind;
    for (const auto& row : relative.m) {
      for (const double x : row) skinning.push_back(static_cast<float>(x));
    }
  }
}

}  // namespace

Rig::Rig(const Skeleton& skeleton)
    : skeleton_(skeleton), features_(joint_features_of(skeleton)), bind_(bind_rotations(skeleton)) {}

// See RigFrame.
void Rig::find_features(const std::vector<JointTransform>& joints, std::vector<float>& features) const {
  features.clear();
  for (const JointFeatures& of : features_) {
    if (of.per_metre > 0) {
      for (const double x : slide_of(of, skeleton_, joints)) features.push_back(static_cast<float>(of.per_metre * x));
      features.resize(features.size() + 6, 0.0f);
      continue;
    }
    const auto r = rotation_matrix(rotation_of(of, skeleton_, bind_, joints));
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 3; ++k) features.push_back(static_cast<float>(r[i][k] - (i == k ? 1 : 0)));
    }
  }
}

void Rig::pose(const Pose& pose, RigFrame& frame) const {
  check_joints(skeleton_, pose.joints);
  check_joints(skeleton_, pose.own_joints());
  frame.world = posed_joints(skeleton_, pose.joints, std::move(frame.world));
  for (int i = 0; i < 3; ++i) frame.origin[i] = frame.world.empty() ? 0.0f : static_cast<float>(frame.world[0].m[i][3]);
  frame.joints.clear();
  for (const Affine& joint : frame.world) {
    for (const auto& row : joint.m) frame.joints.push_back(row[3]);
  }
  relative_skinning(skeleton_, frame.world, frame.origin, frame.skinning);
  frame.learned_skinning = frame.skinning;
  if (!pose.unmodified.empty()) {
    frame.world = posed_joints(skeleton_, pose.unmodified, std::move(frame.world));
    relative_skinning(skeleton_, frame.world, frame.origin, frame.learned_skinning);
  }
  find_features(pose.own_joints(), frame.joint_features);
}

RigFrame pose_rig(const Skeleton& skeleton, const Pose& pose) {
  RigFrame frame;
  Rig(skeleton).pose(pose, frame);
  return frame;
}

}  // namespace bodyopt
