// Motion of one skeleton carried to another that may rest in another pose.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "assets/joint_roles.h"
#include "runtime/basis/skeleton.h"

namespace bodyopt {

struct SourceJoint {
  NamedJoint joint;
  JointTransform rest;      // relative to the parent, file units
  bool has_travel = false;  // its translation is animated, too
};

// The skeleton of a clip's file and how it moves.
struct SourceMotion {
  std::string kind;                 // how notes call it: "BVH"
  bool in_world = false;            // its axes are the world's, and not just any
  std::vector<SourceJoint> joints;  // parents before children
  // Of all joints, relative to their parents.
  std::function<std::vector<JointTransform>(double seconds)> locals_at;
};

// The rest pose of the source may differ from the skeleton's bind pose (arms down in one, stretched out in the other):
//   world rotation of a joint = its world rotation away from the source's rest * alignment * that in the bind pose,
// where the alignment lays the joint's bones at bind along the same bones of the source at rest, with as little twist
// as it takes, once both have the same axes: one is turned by that of the 24 turns between coordinate axes that lays
// the offsets between matched joints best along each other. Of that turn the source takes what makes its up axis y,
// nothing where its axes are the world's, and the skeleton the rest: whoever it is carried to stands and goes where the
// source does, however he faces at bind. Trunks rest alike: their
// bones (by the names of the joints; clavicles, too) differ by build, and not by pose, and are not laid along each
// other, unless one leans 20 degrees from the other on the whole. So do feet within 45 degrees, and bones of joints
// that never turn. Topmost matched joints take their position from the source, where it travels; joints without a match
// keep their bind transform.
class Retarget {
 public:
  // `match`: per joint of the skeleton, its joint of the source, or -1. `frames` at `fps` tell which joints turn. Both
  // the motion and the skeleton must outlive this. Notes say what differs.
  Retarget(const SourceMotion& motion, const Skeleton& skeleton, std::vector<int> match, std::size_t frames, double fps,
           std::vector<std::string>& notes);

  // Metres per unit of the source that make the offsets between matched joints as long, in total, as the skeleton's; 0
  // where no two joints tell.
  double fitted_unit() const;

  // `unit`: metres per unit of the source.
  Pose at(double seconds, double unit) const;

 private:
  // The same bone in both rest poses: from the nearest matched joint above to a matched joint.
  struct BonePair {
    std::size_t above, joint;
    Vec3 skeleton, source;  // metres; file units; world
  };
  std::vector<BonePair> bone_pairs() const;
  Quat fit_turn() const;
  void stand(const Quat& turn);
  bool trunks_rest_alike(const std::vector<std::optional<JointRole>>& roles) const;
  std::vector<bool> turning_joints(std::size_t frames, double fps) const;
  void align_rests(const std::vector<bool>& turns, std::vector<std::string>& notes);
  Vec3 in_bind_axes(std::size_t joint, const Vec3& displacement) const;

  const SourceMotion& motion_;
  const Skeleton& skeleton_;
  std::vector<int> match_;
  Pose base_;                        // the bind pose, as it stands in the world
  std::vector<Affine> bind_;         // per joint, world
  std::vector<Quat> bind_rotation_;  // per joint, world
  std::vector<bool> below_match_;    // per joint: some joint above has a match
  std::vector<Quat> alignment_;      // per joint, world: from the skeleton's bind to the source's rest
  std::vector<Affine> rest_;         // per joint of the source, world
  std::vector<Quat> rest_rotation_;  // per joint of the source, world
  std::vector<bool> travels_;        // per joint of the source: it or one above travels
  std::vector<BonePair> pairs_;
  Quat turn_{0, 0, 0, 1};  // of the source, which makes its up axis y
};

}  // namespace bodyopt
