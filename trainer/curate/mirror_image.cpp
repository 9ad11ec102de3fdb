#include "trainer/curate/mirror_image.h"

#include <algorithm>
#include <cmath>

#include "assets/clips/joint_roles.h"
#include "base/wording.h"
#include "runtime/core/error.h"
#include "runtime/host/rig.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;

// Of the character's size: what the symmetry modifier bears, and what one side may tell of the other unasked.
constexpr double kJointTolerance = 0.02, kSkinTolerance = 0.05;
constexpr double kAlikeJoint = 0.01, kAlikeSkin = 0.001;

Quat mirrored(const Quat& q) { return {q[0], -q[1], -q[2], q[3]}; }  // across a plane of constant x

// The place of every name's counterpart on the other side, or its own.
std::vector<std::size_t> name_counterparts(const std::vector<std::string>& names) {
  std::vector<std::size_t> counterparts;
  for (const int other : mirrored_places(names)) {
    counterparts.push_back(other < 0 ? counterparts.size() : static_cast<std::size_t>(other));
  }
  return counterparts;
}

// The plane that halves the rest skin, and the length of the diagonal around that, metres.
struct MirrorPlane {
  explicit MirrorPlane(const Positions& rest) {
    const Eigen::RowVector3d low = rest.colwise().minCoeff(), high = rest.colwise().maxCoeff();
    middle = 0.5 * (low.x() + high.x());
    size = (high - low).norm();
  }
  Eigen::Vector3d image(const Eigen::RowVector3d& point) const {
    return {2 * middle - point.x(), point.y(), point.z()};
  }
  double middle = 0, size = 0;
};

// How far the image of a joint is from another.
double joints_apart(const Skeleton& skeleton, const MirrorPlane& plane, std::size_t joint, std::size_t other) {
  const Vec3 own = bind_place(skeleton, joint), image{2 * plane.middle - own[0], own[1], own[2]};
  return length(bind_place(skeleton, other) - image);
}

// The joint of the other side's name, or itself; both must lie where the mirror has them.
std::vector<std::size_t> joint_counterparts(const Skeleton& skeleton, const MirrorPlane& plane) {
  std::vector<std::size_t> counterparts = name_counterparts(names_of(skeleton.joints));
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const std::size_t other = counterparts[j];
    const double apart = joints_apart(skeleton, plane, j, other);
    if (apart > kJointTolerance * plane.size) {
      throw Error(ErrorKind::mismatch, "symmetry: the mirror image of joint '", skeleton.joints[j].name, "' is ",
                  std::lround(1e3 * apart), " mm from joint '", skeleton.joints[other].name, "', expected less than ",
                  std::lround(1e3 * kJointTolerance * plane.size),
                  ": the character is not symmetric, or its joints are not named left and right");
    }
  }
  return counterparts;
}

}  // namespace

bool is_own_mirror_image(const Character& character) {
  const MirrorPlane plane(character.vertices);
  const std::vector<std::size_t> counterparts = name_counterparts(names_of(character.skeleton.joints));
  for (std::size_t j = 0; j < counterparts.size(); ++j) {
    if (joints_apart(character.skeleton, plane, j, counterparts[j]) > kAlikeJoint * plane.size) return false;
  }
  const NearestSkin nearest(character.vertices, character.triangles);
  return std::ranges::all_of(character.vertices.rowwise(), [&](const Eigen::RowVector3d& vertex) {
    const Eigen::Vector3d image = plane.image(vertex);
    return (nearest(image).position - image).norm() <= kAlikeSkin * plane.size;
  });
}

MirrorImage::MirrorImage(const Character& character, const std::vector<std::string>& controls)
    : skeleton_(character.skeleton), control_counterpart_(name_counterparts(controls)) {
  const Positions& rest = character.vertices;
  const MirrorPlane plane(rest);
  middle_ = plane.middle;
  counterpart_ = joint_counterparts(skeleton_, plane);
  const NearestSkin nearest(rest, character.triangles);
  for (Index v = 0; v < rest.rows(); ++v) {
    const Eigen::Vector3d image = plane.image(rest.row(v));
    image_.push_back(nearest(image));
    if ((image_.back().position - image).norm() > kSkinTolerance * plane.size) {
      throw Error(ErrorKind::mismatch, "symmetry: the mirror image of vertex ", v, " is ",
                  std::lround(1e3 * (image_.back().position - image).norm()),
                  " mm from the skin: the character is not symmetric");
    }
  }
}

// How far a pose moves a joint against its parent, in the axes of the world at bind; of a root nothing.
Vec3 MirrorImage::moved_from_bind(const Pose& pose, std::size_t j, const std::vector<Quat>& bind) const {
  const Joint& joint = skeleton_.joints[j];
  if (joint.parent < 0) return {0, 0, 0};
  return rotate(bind[static_cast<std::size_t>(joint.parent)], pose.joints[j].translation - joint.bind.translation);
}

Pose MirrorImage::pose(const Pose& pose) const {
  const std::vector<Affine> posed = posed_joints(skeleton_, pose.joints);
  const std::vector<Quat> bind = bind_rotations(skeleton_);
  std::vector<Quat> turns;  // away from bind, world
  for (std::size_t j = 0; j < posed.size(); ++j) {
    turns.push_back(decompose(posed[j]).rotation * conjugate(bind[j]));
  }
  Pose result = pose;
  std::vector<Quat> world(posed.size());
  for (std::size_t j = 0; j < posed.size(); ++j) {
    const Joint& joint = skeleton_.joints[j];
    world[j] = mirrored(turns[counterpart_[j]]) * bind[j];
    JointTransform& own = result.joints[j];
    own = joint.bind;
    if (joint.parent >= 0) {
      const Quat to_parent = conjugate(bind[static_cast<std::size_t>(joint.parent)]);
      const Vec3 moved = moved_from_bind(pose, counterpart_[j], bind);
      own.rotation = normalized(conjugate(world[static_cast<std::size_t>(joint.parent)]) * world[j]);
      own.translation = joint.bind.translation + rotate(to_parent, {-moved[0], moved[1], moved[2]});
    } else {
      const Affine& other = posed[counterpart_[j]];
      own.rotation = normalized(world[j]);
      own.translation = {2 * middle_ - other.m[0][3], other.m[1][3], other.m[2][3]};
    }
  }
  for (std::size_t c = 0; c < control_counterpart_.size(); ++c) {
    result.controls[c] = pose.controls[control_counterpart_[c]];
  }
  return result;
}

Positions MirrorImage::shape(const Positions& shape) const {
  Positions result(shape.rows(), 3);
  for (Index v = 0; v < shape.rows(); ++v) {
    result.row(v) = at_point(shape, image_[static_cast<std::size_t>(v)]);
    result(v, 0) = 2 * middle_ - result(v, 0);
  }
  return result;
}

}  // namespace bodyopt::trainer
