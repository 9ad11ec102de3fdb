#include "trainer/modifiers/measure_push_out.h"

#include <algorithm>
#include <numeric>

#include "base/parallel.h"
#include "geometry/skin_in_skin.h"
#include "geometry/thickness.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "trainer/modifiers/bake_modifier.h"
#include "trainer/modifiers/fold_poses.h"

namespace bodyopt {

void FoldMeasure::add(const FoldMeasure& other) {
  deepest = std::max(deepest, other.deepest);
  deepest_left = std::max(deepest_left, other.deepest_left);
  sum += other.sum;
  sum_left += other.sum_left;
  elsewhere = std::max(elsewhere, other.elsewhere);
}

FoldJudge::FoldJudge(const Basis& basis)
    : basis_(basis),
      triangles_(rest_triangles(basis)),
      shown_(basis),
      kept_(basis.mesh.vertex_count(), 0),
      thickness_(thickness(rest_positions(basis), triangles_)) {
  const std::vector<Pose> rest = {bind_pose(basis.skeleton)};
  for (const BuriedVertex& buried : skin_in_skin(shown_(rest)[0], triangles_, triangles_)) kept_[buried.vertex] = 1;
}

std::vector<FoldMeasure> FoldJudge::operator()(std::span<const Pose> poses,
                                               const std::vector<std::uint32_t>& searched) {
  const SkinModifier& push_out = *basis_.modifiers.of_type(kPushOut);
  std::vector<Pose> without(poses.begin(), poses.end());
  for (Pose& pose : without) {
    if (pose.modifiers.empty()) continue;
    std::fill_n(pose.modifiers.begin() + push_out.first_component, push_out.component_count, 0.0f);
  }
  const std::vector<Positions> before = shown_(without), after = shown_(poses);
  const Triangles chosen = triangles_(searched, Eigen::all);
  std::vector<FoldMeasure> measures(poses.size());
  parallel_for(poses.size(), [&](std::size_t k) { measures[k] = measure(before[k], after[k], chosen); });
  return measures;
}

std::vector<FoldMeasure> FoldJudge::operator()(std::span<const Pose> poses) {
  std::vector<std::uint32_t> all(static_cast<std::size_t>(triangles_.rows()));
  std::iota(all.begin(), all.end(), 0u);
  return (*this)(poses, all);
}

FoldMeasure FoldJudge::measure(const Positions& before, const Positions& after, const Triangles& searched) const {
  FoldMeasure measure;
  std::vector<char> in_skin = kept_;
  const std::vector<BuriedVertex> fold = skin_in_skin(before, triangles_, searched);
  if (goes_through(fold, thickness_)) return measure;
  for (const BuriedVertex& buried : fold) {
    in_skin[buried.vertex] = 1;
    if (kept_[buried.vertex]) continue;
    const double depth = std::min(buried.depth, 0.45 * thickness_[buried.vertex]);
    measure.deepest = std::max(measure.deepest, depth);
    measure.sum += depth;
  }
  for (const BuriedVertex& buried : skin_in_skin(after, triangles_, searched)) {
    if (kept_[buried.vertex]) continue;
    const double depth = std::min(buried.depth, 0.45 * thickness_[buried.vertex]);
    measure.deepest_left = std::max(measure.deepest_left, depth);
    measure.sum_left += depth;
  }
  const Eigen::VectorXd moved = (after - before).rowwise().norm();
  for (Eigen::Index v = 0; v < moved.size(); ++v) {
    if (!in_skin[static_cast<std::size_t>(v)]) measure.elsewhere = std::max(measure.elsewhere, moved[v]);
  }
  return measure;
}

std::vector<JointFolds> measure_push_out(const Basis& given) {
  Basis basis = given;
  for (SkinModifier& modifier : basis.modifiers.stack) modifier.on = modifier.type == kPushOut;
  FoldJudge judge(basis);
  std::vector<JointFolds> joints;
  for (const std::uint32_t joint : folding_joints(basis, thickness(rest_positions(basis), rest_triangles(basis)))) {
    JointFolds folds{basis.skeleton.joints[joint].name, {}};
    std::vector<Pose> poses;
    for (const FoldDirection& direction : fold_directions(basis.skeleton, joint, kFirstMeasured)) {
      for (const double degrees : kMeasuredAngles) poses.push_back(bent_pose(basis.skeleton, direction, degrees));
    }
    drive_modifiers(basis, {}, 1, poses);
    for (const FoldMeasure& measure : judge(poses, triangles_near(basis, joint))) folds.measure.add(measure);
    if (folds.measure.sum > 0 || folds.measure.elsewhere > 0) joints.push_back(folds);
  }
  std::ranges::sort(joints, std::greater(), [](const JointFolds& folds) { return folds.measure.deepest; });
  return joints;
}

}  // namespace bodyopt
