#include "trainer/modifiers/measure_modifiers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>

#include "geometry/mend_surface.h"
#include "geometry/self_intersections.h"
#include "geometry/thickness.h"
#include "runtime/basis/output_order.h"
#include "runtime/basis/skin_modifiers.h"
#include "runtime/cpu/kernels.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "runtime/host/rig.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "trainer/modifiers/joint_holds.h"
#include "trainer/motion/attached_rig.h"
#include "trainer/motion/held_turns.h"

namespace bodyopt::trainer {
namespace {

// Joints that it turns are as before all modifiers: no two types turn the same.
Pose without(const SkinModifier& modifier, Pose pose) {
  std::fill_n(pose.modifiers.begin() + modifier.first_component, modifier.component_count, 0.0f);
  for (const ModifierTurn& turn : modifier.turns) pose.joints[turn.joint] = pose.own_joints()[turn.joint];
  return pose;
}

using FlatPoint = std::array<double, 2>;

// Length of the convex outline of points in a plane (the monotone chain of Andrew 1979).
double outline(std::vector<FlatPoint> points) {
  std::ranges::sort(points);
  std::vector<FlatPoint> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = hull.size();
    for (const FlatPoint& p : points) {
      const auto bends_in = [&] {
        const FlatPoint &a = hull[hull.size() - 2], &b = hull.back();
        return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) <= 0;
      };
      while (hull.size() >= first + 2 && bends_in()) hull.pop_back();
      hull.push_back(p);
    }
    if (!hull.empty()) hull.pop_back();
    std::ranges::reverse(points);
  }
  double length = 0;
  for (std::size_t k = 0; k < hull.size(); ++k) {
    const FlatPoint &a = hull[k], &b = hull[(k + 1) % hull.size()];
    length += std::hypot(a[0] - b[0], a[1] - b[1]);
  }
  return length;
}

// The girth that a tape around the trunk has at this height.
double girth(const Positions& skin, const Triangles& triangles, const Torso& torso, double height) {
  std::vector<FlatPoint> points;
  for_each_edge(triangles, [&](std::uint32_t a, std::uint32_t b) {
    const Eigen::Vector3d pa = skin.row(a).transpose(), pb = skin.row(b).transpose();
    const double ha = torso.height(pa) - height, hb = torso.height(pb) - height;
    if (!(ha * hb < 0) || torso.share[a] < 0.5) return;
    const Eigen::Vector3d p = pa + ha / (ha - hb) * (pb - pa) - torso.hips;
    points.push_back({p.dot(torso.left), p.dot(torso.front)});
  });
  return outline(std::move(points));
}

// V x 3, by the components of the modifier at these weights.
Positions breathed_in(const Basis& basis, const SkinModifier& modifier, double chest, double belly) {
  std::vector<float> weights(basis.modifiers.component_count(), 0.0f);
  weights.at(modifier.first_component) = static_cast<float>(chest);
  weights.at(modifier.first_component + 1) = static_cast<float>(belly);
  std::vector<float> offsets(3 * std::size_t{basis.mesh.vertex_count()});
  cpu::modify_blend(basis.modifiers, weights, 1, offsets);
  return rows_of(offsets);
}

// The weights of chest and belly at the top of the deepest breath of a minute.
std::array<double, 2> deepest_breath(const Basis& basis, const SkinModifier& modifier, float exertion) {
  Basis alone = basis;
  alone.modifiers.stack = {modifier};
  alone.modifiers.stack[0].constants["exertion"] = exertion;
  alone.modifiers.stack[0].constants["irregularity"] = 0;
  alone.modifiers.stack[0].first_component = 0;
  std::vector<Pose> poses(60 * 24, bind_pose(basis.skeleton));
  drive_modifiers(alone, {}, 24, poses);
  const auto top = std::ranges::max_element(poses, {}, [](const Pose& pose) { return pose.modifiers.at(0); });
  return {static_cast<double>(top->modifiers.at(0)), static_cast<double>(top->modifiers.at(1))};
}

constexpr double kDegree = std::numbers::pi / 180, kBent = 130 * kDegree;
constexpr double kLeastRest = 3 * kDegree, kMostRest = 60 * kDegree;  // bent more: the bones are of no limb

// The bind pose with a joint bent further the way it is bent; none where that way is not clear.
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

// The modifiers that act on the posed skin: push-out, then those that follow it.
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

EvaluatedSkin::EvaluatedSkin(Basis basis) {
  deformer_ = std::make_unique<Deformer>(std::move(basis), DeviceChoice{.name = "cpu"});
  deformer_->set_normals(false);
}

EvaluatedSkin::~EvaluatedSkin() = default;

std::vector<Positions> EvaluatedSkin::operator()(std::span<const Pose> poses) {
  const std::vector<float> shown = deformer_->evaluate(poses).positions;
  const MeshTable& mesh = deformer_->basis().mesh;
  const std::size_t values = std::size_t{3} * mesh.output_count();
  std::vector<Positions> skins;
  for (std::size_t n = 0; n < poses.size(); ++n) {
    skins.push_back(rows_of(vertices_of(mesh, std::span(shown).subspan(n * values, values))));
  }
  return skins;
}

Basis without_modifiers(Basis basis) {
  basis.modifiers = {};
  return basis;
}

std::vector<ModifierMove> measure_moves(const Basis& basis, std::span<const Pose> poses) {
  EvaluatedSkin skin(basis);
  const std::vector<Positions> shown = skin(poses);
  std::vector<ModifierMove> moves;
  for (const SkinModifier& modifier : basis.modifiers.stack) {
    if (!modifier.on) continue;
    std::vector<Pose> others;
    for (const Pose& pose : poses) others.push_back(without(modifier, pose));
    const std::vector<Positions> bare = skin(others);
    ModifierMove move{modifier.name};
    for (std::size_t k = 0; k < poses.size(); ++k) {
      const double largest = (shown[k] - bare[k]).rowwise().norm().maxCoeff();
      if (largest > move.largest) move = {modifier.name, largest, k};
    }
    moves.push_back(move);
  }
  return moves;
}

std::vector<BreathMeasure> measure_breathing(const Basis& basis, const SkinModifier& modifier) {
  const Torso torso = find_torso(basis, "the modifier '" + modifier.name + "'");
  const Positions rest = rows_of(basis.mesh.rest);
  const Triangles triangles = rows_of(basis.mesh.triangles);
  std::vector<BreathMeasure> measures;
  for (const auto& [name, exertion] : {std::pair("quiet", 0.0f), std::pair("deep", 1.0f)}) {
    const auto [chest, belly] = deepest_breath(basis, modifier, exertion);
    const Positions skin = rest + breathed_in(basis, modifier, chest, belly);
    BreathMeasure measure;
    measure.name = name;
    measure.litres = 1e3 * (enclosed_volume(skin, triangles) - enclosed_volume(rest, triangles));
    for (double height = 0.40; height < 0.85; height += 0.05) {
      const double before = girth(rest, triangles, torso, height);
      if (!(before > 0)) continue;
      measure.girth_share = std::max(measure.girth_share, girth(skin, triangles, torso, height) / before - 1);
    }
    measure.belly_mm = 1e3 * breathed_in(basis, modifier, 0, belly).rowwise().norm().maxCoeff();
    measures.push_back(measure);
  }
  return measures;
}

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
  const auto add = [&](const Positions& skin, double& deepest, double& sum) {
    for (const BuriedVertex& buried : skin_in_skin(skin, triangles_)) {
      if (kept_[buried.vertex]) continue;
      deepest = std::max(deepest, buried.depth);
      sum += buried.depth;
    }
  };
  add(before, measure.deepest, measure.sum);
  add(after, measure.deepest_left, measure.sum_left);
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

}  // namespace bodyopt::trainer
