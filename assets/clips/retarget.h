// Motion of one skeleton transferred to another that may rest in another pose.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "assets/clips/source_motion.h"
#include "runtime/basis/skeleton.h"

namespace bodyopt {

// The rest pose of the source may differ from the skeleton's bind pose (arms down in one, stretched out in the other).
// A joint's world rotation = its world rotation away from the source's rest * alignment * that in the bind pose.
// The alignment lays the joint's bones at bind along those of the source at rest, with as little twist as it takes.
// Before, one of the 24 turns between coordinate axes lays the offsets between matched joints best along each other.
// The source turns until the axis that its motion has up (up_of_motion) is y, unless its axes are the world's. The
// skeleton then stands and goes where the source does, whichever way it faces at bind. Bones of trunks (by the joints'
// names; clavicles, too) differ by build, and not by pose. They are not aligned, unless trunks are turned by 20 degrees
// on the whole. Nor are feet within 45 degrees; clavicles beyond that differ by pose. Topmost matched joints take their
// position from the source, where it travels; joints without a match keep their bind transform.
//
// The rest pose of a source may be none: bones lie along axes of their joints, whatever these are. Only a frame is a
// pose. The twist about a bone then comes from the motion, as it does for a bone that rests over 120 degrees away.
// Knees bend back and elbows of stretched out arms to the front; a forearm goes with the palm that fingers span. Other
// joints twist over the frames to either side alike, against the joint above. Where bones keep to axes, so do the axes
// across them, in the bind pose. Where trunks are of other build, necks, hip joints and clavicles are on the mean
// as at bind.
class Retarget {
 public:
  // `match`: per joint of the skeleton, its joint of the source, or -1. `frames` at `fps` tell what the motion is like.
  // Both the motion and the skeleton must outlive this. Notes say what differs.
  Retarget(const SourceMotion& motion, const Skeleton& skeleton, std::vector<int> match, std::size_t frames, double fps,
           std::vector<std::string>& notes);

  // Metres per unit of the source that make the offsets between matched joints as long, in total, as the skeleton's. It
  // is 0 where no two joints tell.
  double fitted_unit() const;

  // `unit`: metres per unit of the source.
  Pose at(double seconds, double unit) const;

 private:
  std::vector<BonePair> bone_pairs() const;
  Quat fit_turn() const;
  void stand(const Quat& turn);
  bool turns_little() const;
  bool rests_in_a_pose(const Quat& fitted) const;
  void take_bones_of_motion();
  bool trunks_rest_alike() const;
  bool trunks_are_of_one_build() const;
  int matched_above(std::size_t joint) const;
  Quat mean_turn(std::size_t joint, std::size_t other) const;
  Quat twisted_alike(std::size_t joint, std::size_t other, const Quat& alignment) const;
  Vec3 leftwards(BodyPart part, const std::function<Vec3(std::size_t joint)>& place) const;
  std::optional<Quat> bent_alike(std::size_t joint) const;
  std::optional<Quat> palm_alike(std::size_t joint) const;
  Quat twisted_by_motion(std::size_t joint) const;
  bool has_bones_along_axes() const;
  Quat nearest_of_axes(std::size_t joint, const Quat& alignment) const;
  void align_rests(std::vector<std::string>& notes);
  Quat away_from_rest(const SourceFrame& frame, std::size_t joint) const;

  const SourceMotion& motion_;
  const Skeleton& skeleton_;
  std::vector<int> match_;
  std::vector<std::optional<JointRole>> roles_;  // per joint
  Pose base_;                                    // the bind pose, as it stands in the world
  std::vector<Affine> bind_;                     // per joint, world
  std::vector<Quat> bind_rotation_;              // per joint, world
  std::vector<bool> below_match_;                // per joint: some joint above has a match
  std::vector<Quat> alignment_;                  // per joint, world: from the skeleton's bind to the source's rest
  SourceFrame rest_;                             // of the source
  std::vector<bool> travels_;                    // per joint of the source: it or one above travels
  std::vector<BonePair> pairs_;
  std::vector<SourceFrame> frames_;  // of the source, some
  bool is_pose_ = true;              // the rest of the source
  Quat turn_{0, 0, 0, 1};            // of the source, which makes its up axis y
};

}  // namespace bodyopt
