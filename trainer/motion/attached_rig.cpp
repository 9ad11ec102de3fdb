#include "trainer/motion/attached_rig.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "assets/characters/joints_with_skin.h"
#include "base/wording.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "runtime/host/rig.h"

namespace bodyopt::trainer {
namespace {

void renumber(JointLimits& limits, const std::vector<std::uint32_t>& number) {
  for (DegreeOfFreedom& dof : limits.dofs) {
    for (JointTurn& turn : dof.turns) turn.joint = number[turn.joint];
  }
  for (JointDeviation& deviation : limits.deviations) deviation.joint = number[deviation.joint];
}

constexpr double kHolds = 0.1;  // of a vertex: with less a joint's skin is not taken to reach there

// How many triangles every pair of joints shares: both hold a corner of them.
std::vector<std::vector<int>> shared_triangles(const Character& character) {
  const std::size_t count = character.skeleton.size();
  std::vector<std::vector<int>> shared(count, std::vector<int>(count, 0));
  for (Eigen::Index t = 0; t < character.triangles.rows(); ++t) {
    std::set<std::uint32_t> joints;
    for (const std::uint32_t corner : character.triangles.row(t)) {
      for (const JointWeight& weight : character.weights[corner]) {
        if (weight.weight >= kHolds) joints.insert(weight.joint);
      }
    }
    for (const std::uint32_t one : joints) {
      for (const std::uint32_t other : joints) ++shared[one][other];
    }
  }
  return shared;
}

class Detached {
 public:
  explicit Detached(const Character& character)
      : skeleton_(character.skeleton),
        shared_(shared_triangles(character)),
        with_skin_(joints_with_skin(character)),
        of_all_skin_(joints_of_all_skin(character)) {
    for (std::size_t j = 0; j < with_skin_.size(); ++j) all_ += skeleton_.joints[j].parent < 0 ? with_skin_[j] : 0;
  }

  // The joint at the end of a limb that the joint's skin goes on from, or -1.
  int followed_by(std::uint32_t joint) const {
    const int parent = skeleton_.joints[joint].parent;
    if (is_body(joint) || touches_one_above(joint)) return -1;
    int most = -1;
    for (std::uint32_t k = 0; k < skeleton_.size(); ++k) {
      if (is_root(k) || hangs_under(skeleton_, {}, k, joint)) continue;
      if (shared_[joint][k] > (most < 0 ? 0 : shared_[joint][static_cast<std::size_t>(most)]))
        most = static_cast<int>(k);
    }
    if (most < 0) return -1;
    const auto k = static_cast<std::size_t>(most);
    return with_skin_[k] == 1 && skeleton_.joints[k].parent != parent ? most : -1;
  }

 private:
  // Feet go on from it, not it from them.
  bool is_body(std::size_t joint) const { return of_all_skin_[joint] || 2 * with_skin_[joint] >= all_; }
  // Skin that follows a root follows it for want of another joint.
  bool is_root(std::size_t joint) const {
    return of_all_skin_[joint] || (skeleton_.joints[joint].parent < 0 && is_body(joint));
  }

  bool touches_one_above(std::size_t joint) const {
    for (int above = skeleton_.joints[joint].parent; above >= 0;) {
      const auto k = static_cast<std::size_t>(above);
      if (!is_root(k) && shared_[joint][k] > 0) return true;
      above = skeleton_.joints[k].parent;
    }
    return false;
  }

  const Skeleton& skeleton_;
  std::vector<std::vector<int>> shared_;
  std::vector<int> with_skin_;
  std::vector<bool> of_all_skin_;
  int all_ = 0;  // joints with skin
};

// Own joints in an order in which parents come first.
std::vector<std::uint32_t> parents_first(const std::vector<int>& parents) {
  std::vector<std::uint32_t> order;
  std::vector<bool> done(parents.size(), false);
  while (order.size() < parents.size()) {
    const std::size_t before = order.size();
    for (std::uint32_t j = 0; j < parents.size(); ++j) {
      if (done[j] || (parents[j] >= 0 && !done[static_cast<std::size_t>(parents[j])])) continue;
      done[j] = true;
      order.push_back(j);
    }
    if (order.size() == before) throw Error(ErrorKind::mismatch, "joints that follow each other hang on nothing");
  }
  return order;
}

// Local transforms of the joints under their parents in `to`: the k-th is the order[k]-th joint of `from`.
std::vector<JointTransform> rehung(const Skeleton& from, const Skeleton& to, const std::vector<std::uint32_t>& order,
                                   const std::vector<JointTransform>& joints) {
  const std::vector<Affine> world = posed_joints(from, joints);
  std::vector<JointTransform> result;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const int above = to.joints[k].parent;
    const int parent = above < 0 ? -1 : static_cast<int>(order[static_cast<std::size_t>(above)]);
    const Affine& joint = world[order[k]];
    if (parent == from.joints[order[k]].parent) {
      result.push_back(joints[order[k]]);
    } else {
      result.push_back(decompose(parent < 0 ? joint : inverse(world[static_cast<std::size_t>(parent)]) * joint));
    }
  }
  return result;
}

Pose rehung(const Skeleton& from, const Skeleton& to, const std::vector<std::uint32_t>& order, Pose pose) {
  pose.joints = rehung(from, to, order, pose.joints);
  if (!pose.unmodified.empty()) pose.unmodified = rehung(from, to, order, pose.unmodified);
  return pose;
}

// Whether the joint's bind under another one is more than a place, a turn and a scale along its axes.
bool shears(const Skeleton& skeleton, std::uint32_t above, std::uint32_t joint) {
  constexpr double kMost = 1e-4;  // of its axes' lengths
  const std::vector<Affine> world = posed_joints(skeleton, bind_pose(skeleton).joints);
  const Affine local = inverse(world[above]) * world[joint], again = affine_from(decompose(local));
  double off = 0, size = 0;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      off = std::max(off, std::abs(again.m[row][column] - local.m[row][column]));
      size = std::max(size, std::abs(local.m[row][column]));
    }
  }
  return off > kMost * size;
}

}  // namespace

std::vector<DetachedJoint> detached_joints(const Character& character) {
  const Detached detached(character);
  std::vector<DetachedJoint> result;
  std::set<int> limbs;
  for (std::uint32_t j = 0; j < character.skeleton.size(); ++j) {
    const int follows = detached.followed_by(j);
    const std::uint32_t limb = static_cast<std::uint32_t>(follows);
    if (follows < 0 || hangs_under(character.skeleton, result, limb, j) || shears(character.skeleton, limb, j))
      continue;
    limbs.insert(follows);
    result.push_back({j, limb, "its skin goes on from that of this joint, and of none that it hangs under"});
  }
  // A limb's end cannot be told from a limb that itself goes on from another one's end.
  std::erase_if(result, [&](const DetachedJoint& of) { return limbs.contains(static_cast<int>(of.joint)); });
  return result;
}

AttachedRig::AttachedRig(const Skeleton& skeleton, const std::vector<DetachedJoint>& detached)
    : own_(skeleton), detached_(detached), place_(skeleton.size()) {
  for (const DetachedJoint& of : detached) {
    const std::string who =
        "'" + skeleton.joints[of.joint].name + "' cannot follow '" + skeleton.joints[of.follows].name + "'";
    if (hangs_under(skeleton, {}, of.follows, of.joint))
      throw Error(ErrorKind::mismatch, who + ", which hangs under it");
    if (shears(skeleton, of.follows, of.joint)) {
      throw Error(ErrorKind::mismatch,
                  who +
                      ", whose scale is not the same along all axes: apply scales to the rig, or leave "
                      "it out of detached_joints");
    }
  }
  std::vector<int> parents = transformed(skeleton.joints, &Joint::parent);
  for (const DetachedJoint& of : detached) parents[of.joint] = static_cast<int>(of.follows);
  own_of_ = parents_first(parents);
  for (std::uint32_t k = 0; k < own_of_.size(); ++k) place_[own_of_[k]] = k;
  for (const std::uint32_t j : own_of_) {
    Joint joint = skeleton.joints[j];
    joint.parent = parents[j] < 0 ? -1 : static_cast<int>(place_[static_cast<std::size_t>(parents[j])]);
    attached_.joints.push_back(joint);
  }
  const Pose bind = attached(bind_pose(skeleton));
  for (std::size_t k = 0; k < attached_.size(); ++k) attached_.joints[k].bind = bind.joints[k];
}

Character AttachedRig::attached(Character character) const {
  character.skeleton = attached_;
  for (auto& weights : character.weights) {
    for (JointWeight& weight : weights) weight.joint = place_[weight.joint];
  }
  return character;
}

JointLimits AttachedRig::attached(JointLimits limits) const {
  renumber(limits, place_);
  limits.detached.clear();
  return limits;
}

JointLimits AttachedRig::detached(JointLimits limits) const {
  renumber(limits, own_of_);
  limits.detached = detached_;
  return limits;
}

Pose AttachedRig::attached(Pose pose) const { return rehung(own_, attached_, own_of_, std::move(pose)); }

std::vector<Pose> AttachedRig::attached(const std::vector<Pose>& poses) const {
  return transformed(poses, [&](const Pose& pose) { return attached(pose); });
}

Pose AttachedRig::detached(Pose pose) const { return rehung(attached_, own_, place_, std::move(pose)); }

Clip AttachedRig::detached(Clip clip) const {
  for (Pose& pose : clip.poses) pose = detached(pose);
  return clip;
}

std::string detached_text(const std::vector<DetachedJoint>& detached, const Skeleton& skeleton) {
  const std::vector<std::string> pairs = transformed(detached, [&](const DetachedJoint& of) {
    return skeleton.joints[of.joint].name + "' follows '" + skeleton.joints[of.follows].name;
  });
  return pairs.empty() ? ""
                       : "by its skin " + list_names(pairs, pairs.size()) +
                             " in motion made from limits, though it hangs elsewhere in the rig";
}

}  // namespace bodyopt::trainer
