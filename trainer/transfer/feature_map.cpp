#include "trainer/transfer/feature_map.h"

#include "runtime/host/rig.h"

namespace bodyopt {
namespace {

using Rotation = std::array<std::array<double, 3>, 3>;

// Number of each joint's nine features over nine; -1 for roots.
std::vector<int> feature_places(const Skeleton& skeleton) {
  std::vector<int> places(skeleton.size(), -1);
  int next = 0;
  for (const std::uint32_t joint : feature_joints(skeleton)) places[joint] = next++;
  return places;
}

// Joints of the target from `below` up to, and without, `above`; empty where `above` is not above it.
std::vector<std::size_t> chain_between(const Skeleton& target, int above, int below) {
  std::vector<std::size_t> chain;
  for (int j = below; j != above; j = target.joints[static_cast<std::size_t>(j)].parent) {
    chain.push_back(static_cast<std::size_t>(j));
    if (target.joints[static_cast<std::size_t>(j)].parent < 0) return {};
  }
  return chain;
}

// The nine features of one joint of the source.
void write_joint(const Skeleton& target, const SkeletonMatch& match, int above, int below,
                 const std::vector<int>& places, FeatureFormula* formulas) {
  const std::vector<std::size_t> chain = chain_between(target, above, below);
  if (chain.empty()) return;
  const Rotation up = rotation_matrix(match.alignment[static_cast<std::size_t>(above)]),
                 own = rotation_matrix(match.alignment[static_cast<std::size_t>(below)]);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t l = 0; l < 3; ++l) {
      FeatureFormula& formula = formulas[3 * i + l];
      formula.constant = i == l ? -1.0 : 0.0;
      for (std::size_t p = 0; p < 3; ++p) formula.constant += up[i][p] * own[l][p];
      if (match.alignment[static_cast<std::size_t>(above)] == match.alignment[static_cast<std::size_t>(below)]) {
        formula.constant = 0;  // but for rounding
      }
      for (const std::size_t joint : chain) {
        for (std::size_t k = 0; k < 9; ++k) {
          const double factor = up[i][k / 3] * own[l][k % 3];
          if (factor != 0)
            formula.terms.push_back(
                {static_cast<std::uint32_t>(9 * places[joint]) + static_cast<std::uint32_t>(k), factor});
        }
      }
    }
  }
}

int matched_above(const Skeleton& source, const SkeletonMatch& match, std::size_t joint) {
  int above = source.joints[joint].parent;
  while (above >= 0 && match.target_joint[static_cast<std::size_t>(above)] < 0) {
    above = source.joints[static_cast<std::size_t>(above)].parent;
  }
  return above;
}

}  // namespace

std::vector<FeatureFormula> feature_formulas(const Basis& source, const Skeleton& target, const SkeletonMatch& match,
                                             const std::vector<float>& strain_at_rest) {
  const std::vector<std::uint32_t> joints = feature_joints(source.skeleton);
  const std::vector<int> places = feature_places(target);
  std::vector<FeatureFormula> formulas(9 * joints.size());
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const int above = matched_above(source.skeleton, match, joints[k]), below = match.target_joint[joints[k]];
    if (above < 0 || below < 0) continue;
    write_joint(target, match, match.target_joint[static_cast<std::size_t>(above)], below, places, &formulas[9 * k]);
  }
  std::uint32_t next = joint_feature_count(target);
  for (const float strain : strain_at_rest) formulas.push_back({{{next++, 1 + double{strain}}}, double{strain}});
  for (std::size_t k = 0; k < source.residual.controls.size(); ++k) formulas.push_back({{{next++, 1.0}}, 0});
  return formulas;
}

Pose pose_at_target_rest(const SkeletonMatch& match, const Skeleton& source) {
  Pose pose = bind_pose(source);
  const std::vector<Quat> bind = bind_rotations(source);
  std::vector<Quat> away(source.size());
  for (std::size_t j = 0; j < source.size(); ++j) {
    const int parent = source.joints[j].parent, other = match.target_joint[j];
    const Quat above = parent < 0 ? Quat{0, 0, 0, 1} : away[static_cast<std::size_t>(parent)];
    away[j] = other >= 0 ? conjugate(match.alignment[static_cast<std::size_t>(other)]) : above;
    const Quat world_above = parent < 0 ? above : above * bind[static_cast<std::size_t>(parent)];
    if (away[j] != above || parent < 0)
      pose.joints[j].rotation = normalized(conjugate(world_above) * away[j] * bind[j]);
  }
  return pose;
}

}  // namespace bodyopt
