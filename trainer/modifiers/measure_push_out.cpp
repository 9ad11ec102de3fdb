#include "trainer/modifiers/measure_push_out.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>

#include "geometry/skin_in_skin.h"
#include "geometry/table_rows.h"
#include "geometry/thickness.h"
#include "runtime/basis/skin_modifiers.h"
#include "runtime/host/rig.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "trainer/modifiers/bake_modifier.h"
#include "trainer/modifiers/joint_holds.h"
#include "trainer/motion/attached_rig.h"
#include "trainer/motion/limited_pose.h"

namespace bodyopt {
namespace {

constexpr double kDegree = std::numbers::pi / 180, kBent = 130 * kDegree;
constexpr double kLeastRest = 3 * kDegree, kMostRest = 60 * kDegree;  // bent more: the bones are of no limb

// The bind pose with a joint bent further the way it is bent; none where that is not to be told.
std::optional<Pose> bent_pose(const Skeleton& skeleton, std::uint32_t joint) {
  const int parent = skeleton.joints[joint].parent;
  if (parent < 0 || skeleton.joints[static_cast<std::size_t>(parent)].parent < 0) return std::nullopt;
  const Vec3 above = bind_place(skeleton, joint) - bind_place(skeleton, static_cast<std::uint32_t>(parent)),
             below = bone_of(skeleton, joint), across = cross(above, below);
  const double rest = std::atan2(length(across), dot(above, below));
  if (!(rest > kLeastRest && rest < kMostRest)) return std::nullopt;
  const Quat axes = bind_rotations(skeleton)[static_cast<std::size_t>(parent)];
  Pose pose = bind_pose(skeleton);
  Quat& rotation = pose.joints[joint].rotation;
  rotation = conjugate(axes) * axis_angle((1 / length(across)) * across, kBent - rest) * axes * rotation;
  return pose;
}

// J: is the bone longer than the skin that goes with it is thick? A neck's or a spine's does not fold, it is crushed.
std::vector<char> slender_joints(const Basis& basis) {
  const Eigen::VectorXd thick = thickness(rows_of(basis.mesh.rest), rows_of(basis.mesh.triangles));
  std::vector<double> sum(basis.skeleton.size(), 0), count(sum);
  for (std::uint32_t v = 0; v < basis.mesh.vertex_count(); ++v) {
    sum[basis.ddm.vertices[v].base_joint] += thick[v];
    count[basis.ddm.vertices[v].base_joint] += 1;
  }
  std::vector<char> slender;
  for (std::uint32_t j = 0; j < sum.size(); ++j)
    slender.push_back(count[j] * length(bone_of(basis.skeleton, j)) > sum[j]);
  return slender;
}

// What acts on the posed skin: push-out, then what follows it.
std::vector<SkinModifier> from_push_out_on(const std::vector<SkinModifier>& stack) {
  std::vector<SkinModifier> acting;
  for (const SkinModifier& modifier : stack) {
    if (modifier.type == kPushOut.name || (!acting.empty() && posed_skin_type(modifier.type)))
      acting.push_back(modifier);
  }
  return acting;
}

std::vector<Pose> switched_off(std::span<const Pose> poses, std::span<const SkinModifier> modifiers) {
  std::vector<Pose> without(poses.begin(), poses.end());
  for (Pose& pose : without) {
    if (pose.modifiers.empty()) continue;
    for (const SkinModifier& modifier : modifiers) {
      std::fill_n(pose.modifiers.begin() + modifier.first_component, modifier.component_count, 0.0f);
    }
  }
  return without;
}

std::vector<BentJoint> measure_folds(Basis basis, const std::vector<std::string>& names, std::vector<Pose> poses) {
  for (SkinModifier& modifier : basis.modifiers.stack) modifier.on = modifier.type == kPushOut.name;
  drive_modifiers(basis, {}, 1, poses);
  const std::vector<FoldMeasure> measures = FoldJudge(basis)(poses);
  std::vector<BentJoint> folds;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (measures[k].sum > 0) folds.push_back({names[k], measures[k]});
  }
  std::ranges::sort(folds, std::greater(), [](const BentJoint& fold) { return fold.measure.deepest; });
  return folds;
}

}  // namespace

void FoldMeasure::add(const FoldMeasure& other) {
  deepest = std::max(deepest, other.deepest);
  deepest_left = std::max(deepest_left, other.deepest_left);
  sum += other.sum;
  sum_left += other.sum_left;
  elsewhere = std::max(elsewhere, other.elsewhere);
}

FoldJudge::FoldJudge(const Basis& basis)
    : basis_(basis), triangles_(rows_of(basis.mesh.triangles)), shown_(basis), kept_(basis.mesh.vertex_count(), 0) {
  for (const BuriedVertex& buried : skin_in_skin(rows_of(basis.mesh.rest), triangles_)) kept_[buried.vertex] = 1;
}

std::vector<FoldMeasure> FoldJudge::operator()(std::span<const Pose> poses) {
  const std::vector<SkinModifier> acting = from_push_out_on(basis_.modifiers.stack);
  const std::span<const SkinModifier> later = std::span(acting).subspan(1);
  const std::vector<Positions> before = shown_(switched_off(poses, std::span(acting).first(1))), after = shown_(poses),
                               own_before = later.empty() ? before : shown_(switched_off(poses, acting)),
                               own_after = later.empty() ? after : shown_(switched_off(poses, later));
  std::vector<FoldMeasure> measures;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    measures.push_back(measure(before[k], after[k]));
    measures.back().elsewhere = elsewhere(own_before[k], own_after[k]);
  }
  return measures;
}

FoldMeasure FoldJudge::measure(const Positions& before, const Positions& after) const {
  FoldMeasure measure;
  for (const BuriedVertex& buried : skin_in_skin(before, triangles_)) {
    if (kept_[buried.vertex]) continue;
    measure.deepest = std::max(measure.deepest, buried.depth);
    measure.sum += buried.depth;
  }
  for (const BuriedVertex& buried : skin_in_skin(after, triangles_)) {
    if (kept_[buried.vertex]) continue;
    measure.deepest_left = std::max(measure.deepest_left, buried.depth);
    measure.sum_left += buried.depth;
  }
  return measure;
}

double FoldJudge::elsewhere(const Positions& before, const Positions& after) const {
  Eigen::VectorXd moved = (after - before).rowwise().norm();
  for (const BuriedVertex& buried : skin_in_skin(before, triangles_)) moved[buried.vertex] = 0;
  return moved.maxCoeff();
}

std::vector<BentJoint> measure_push_out(const Basis& basis) {
  const std::vector<char> slender = slender_joints(basis);
  std::vector<std::string> names;
  std::vector<Pose> poses;
  for (const std::uint32_t joint : basis.modifiers.of_type(kPushOut.name)->joints) {
    const std::optional<Pose> bent = bent_pose(basis.skeleton, joint);
    if (!bent || !slender[joint]) continue;
    names.push_back(basis.skeleton.joints[joint].name);
    poses.push_back(*bent);
  }
  return measure_folds(basis, names, std::move(poses));
}

std::vector<BentJoint> measure_push_out(const Basis& basis, const JointLimits& limits) {
  const AttachedRig rig(basis.skeleton, limits.detached);
  const JointLimits attached = rig.attached(limits);
  std::vector<std::string> names;
  std::vector<Pose> poses;
  for (std::size_t k = 0; k < limits.dofs.size(); ++k) {
    const DegreeOfFreedom& dof = limits.dofs[k];
    for (const double end : {dof.min, dof.max}) {
      Posture posture{rest_angles(limits)};
      posture.angles[k] = end;
      names.push_back(dof.name + " " + std::to_string(std::lround(end)));
      poses.push_back(rig.detached(limited_pose(rig.skeleton(), attached, posture)));
    }
  }
  return measure_folds(basis, names, std::move(poses));
}

}  // namespace bodyopt
