#include "runtime/deformer/make_batch.h"

#include <cmath>

#include "runtime/core/error.h"
#include "runtime/host/fade.h"
#include "runtime/host/rig.h"

namespace bodyopt {
namespace {

// Pose::modifiers, one for each component. A basis without any, such as a lighter level, has nothing to weigh.
std::vector<float> modifier_weights(const Basis& basis, const Pose& pose) {
  const std::size_t count = basis.modifiers.component_count();
  if (count == 0) return {};
  if (!pose.modifiers.empty() && pose.modifiers.size() != count) {
    throw Error(ErrorKind::mismatch, "a pose has ", pose.modifiers.size(), " weights of modifiers, the basis has ",
                count);
  }
  for (const float weight : pose.modifiers) {
    if (!std::isfinite(weight)) throw Error(ErrorKind::mismatch, "a modifier's weight is not a finite number");
  }
  std::vector<float> weights = pose.modifiers;
  weights.resize(count, 0.0f);
  return weights;
}

void check_controls(const Basis& basis, const Pose& pose) {
  const std::size_t controls = basis.residual.controls.size();
  if (!pose.controls.empty() && pose.controls.size() != controls) {
    throw Error(ErrorKind::mismatch, "a pose has ", pose.controls.size(), " control values, the basis has ", controls,
                " controls");
  }
  for (std::size_t c = 0; c < pose.controls.size(); ++c) {
    if (std::isfinite(pose.controls[c])) continue;
    throw Error(ErrorKind::mismatch, "the control '", basis.residual.controls[c], "' is not a finite number");
  }
}

}  // namespace

Batch make_batch(const Basis& basis, std::span<const Pose> poses) {
  Batch batch;
  batch.frame_count = static_cast<std::uint32_t>(poses.size());
  const std::size_t controls = basis.residual.controls.size();
  for (const Pose& pose : poses) {
    const RigFrame rig = pose_rig(basis.skeleton, pose);
    batch.skinning.insert(batch.skinning.end(), rig.skinning.begin(), rig.skinning.end());
    batch.origins.insert(batch.origins.end(), {rig.origin[0], rig.origin[1], rig.origin[2], 0.0f});
    batch.joint_features.insert(batch.joint_features.end(), rig.joint_features.begin(), rig.joint_features.end());
    if (basis.modifiers.turn_joints()) {
      batch.learned_skinning.insert(batch.learned_skinning.end(), rig.learned_skinning.begin(),
                                    rig.learned_skinning.end());
    }
    batch.joints.insert(batch.joints.end(), rig.joints.begin(), rig.joints.end());
    const std::vector<float> fades = region_fades(basis.residual, rig.joint_features);
    batch.fades.insert(batch.fades.end(), fades.begin(), fades.end());
    check_controls(basis, pose);
    std::vector<float> values = pose.controls;
    values.resize(controls, 0.0f);
    batch.controls.insert(batch.controls.end(), values.begin(), values.end());
    const std::vector<float> weights = modifier_weights(basis, pose);
    batch.modifiers.insert(batch.modifiers.end(), weights.begin(), weights.end());
  }
  return batch;
}

}  // namespace bodyopt
