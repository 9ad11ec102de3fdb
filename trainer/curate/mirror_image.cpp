#include "trainer/curate/mirror_image.h"

#include <cmath>

#include "assets/joint_roles.h"
#include "assets/wording.h"
#include "runtime/core/error.h"
#include "runtime/host/rig.h"

namespace bodyopt {
namespace {

using Eigen::Index;

constexpr double kJointTolerance = 0.02, kSkinTolerance = 0.05;  // of the character's size

Quat mirrored(const Quat& q) { return {q[0], -q[1], -q[2], q[3]}; }  // across a plane of constant x

// Of every name the place of that of the other side, or its own.
std::vector<std::size_t> name_counterparts(const std::vector<std::string>& names) {
  std::vector<std::size_t> counterparts;
  for (const int other : mirrored_places(names)) {
    counterparts.push_back(other < 0 ? counterparts.size() : static_cast<std::size_t>(other));
  }
  return counterparts;
}

// The joint of the other side's name, or itself; both must lie where the mirror has them.
std::vector<std::size_t> joint_counterparts(const Skeleton& skeleton, double middle, double size) {
  std::vector<std::size_t> counterparts = name_counterparts(names_of(skeleton.joints));
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const std::size_t other = counterparts[j];
    const Vec3 own = bind_place(skeleton, j), image{2 * middle - own[0], own[1], own[2]};
    const double apart = length(bind_place(skeleton, other) - image);
    if (apart > kJointTolerance * size) {
      throw Error(ErrorKind::mismatch,
                  "symmetry: the mirror image of joint '" + skeleton.joints[j].name + "' is " +
                      std::to_string(std::lround(1e3 * apart)) + " mm from joint '" + skeleton.joints[other].name +
                      "', expected less than " + std::to_string(std::lround(1e3 * kJointTolerance * size)) +
                      ": the character is not symmetric, or its joints are not named left and right");
    }
  }
  return counterparts;
}

}  // namespace

MirrorImage::MirrorImage(const Character& character, const std::vector<std::string>& controls)
    : skeleton_(character.skeleton), control_counterpart_(name_counterparts(controls)) {
  const Positions& rest = character.vertices;
  const Eigen::RowVector3d low = rest.colwise().minCoeff(), high = rest.colwise().maxCoeff();
  middle_ = 0.5 * (low.x() + high.x());
  const double size = (high - low).norm();
  counterpart_ = joint_counterparts(skeleton_, middle_, size);
  const NearestSkin nearest(rest, character.triangles);
  for (Index v = 0; v < rest.rows(); ++v) {
    const Eigen::Vector3d image(2 * middle_ - rest(v, 0), rest(v, 1), rest(v, 2));
    image_.push_back(nearest(image));
    if ((image_.back().position - image).norm() > kSkinTolerance * size) {
      throw Error(ErrorKind::mismatch, "symmetry: the mirror image of vertex " + std::to_string(v) + " is " +
                                           std::to_string(std::lround(1e3 * (image_.back().position - image).norm())) +
                                           " mm from the skin: the character is not symmetric");
    }
  }
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
      own.rotation = normalized(conjugate(world[static_cast<std::size_t>(joint.parent)]) * world[j]);
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

}  // namespace bodyopt
