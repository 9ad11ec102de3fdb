// Push-out: the normals of folds that are bent far enough to close. A bone that turns away from where it points at rest
// leaves a fold between it and the limb above. The fold's normal is half-way between their directions
// (shaders/include/fold.h).
//   Joints: one for each fold. Components: three to a fold, its normal. Numbers: the metres that skin moves at most.
//   Then of each fold where its joint stands at rest, how far from there skin belongs to it, and the bone's direction.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "runtime/modifiers/drive_modifiers.h"
#include "runtime/modifiers/skin_modifier_type.h"

namespace bodyopt {
namespace {

constexpr double kOneLimb = 0.5;              // cosine of what its bones are bent at most at rest
constexpr double kBegins = 30, kInFull = 45;  // degrees that a bone is turned

double shown_at(double cosine) {
  const double degrees = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
  return std::clamp((degrees - kBegins) / (kInFull - kBegins), 0.0, 1.0);
}

// A fold at rest.
struct Fold {
  std::size_t joint, parent;
  Vec3 bone, limb;  // directions of the bone, and of where the limb that it bends comes from
};

// The bone above, where both are of one limb, or the bone's own.
Vec3 limb_direction(const Skeleton& skeleton, std::size_t joint, std::size_t parent, const Vec3& bone) {
  const Vec3 above = bind_place(skeleton, joint) - bind_place(skeleton, parent);
  const double size = length(above);
  return size > 1e-6 && dot(above, bone) > kOneLimb * size ? (1 / size) * above : bone;
}

std::vector<Fold> folds_at_rest(const Skeleton& skeleton, const SkinModifier& modifier) {
  std::vector<Fold> folds;
  for (std::size_t k = 0; k < modifier.joints.size(); ++k) {
    const std::size_t joint = modifier.joints[k];
    if (skeleton.joints[joint].parent < 0) throw std::out_of_range("a fold's joint");
    const auto parent = static_cast<std::size_t>(skeleton.joints[joint].parent);
    Vec3 bone;
    for (std::size_t i = 0; i < 3; ++i) bone[i] = static_cast<double>(modifier.numbers.at(5 + 7 * k + i));
    folds.push_back({joint, parent, bone, limb_direction(skeleton, joint, parent, bone)});
  }
  return folds;
}

// The normal is as long as the fold is shown.
Vec3 fold_normal(const Vec3& bone, const Vec3& straight, const Vec3& limb) {
  const Vec3 sum = bone + limb;
  const double size = length(sum);
  if (!(size > 1e-6)) return {0, 0, 0};  // turned back on itself
  return shown_at(dot(bone, straight)) / size * sum;
}

}  // namespace

void drive_push_out(const ModifierFrames& frames, std::span<float> weights) {
  const SkinModifier& modifier = frames.modifier;
  const Skeleton& skeleton = frames.basis.skeleton;
  if (modifier.component_count != 3 * modifier.joints.size()) throw std::out_of_range("components of push-out");
  const std::vector<Fold> folds = folds_at_rest(skeleton, modifier);
  const std::vector<Quat> bind = world_rotations(skeleton, bind_pose(skeleton));
  for (std::size_t f = 0; f < frames.count(); ++f) {
    const std::vector<Quat> posed = world_rotations(skeleton, frames.poses[f]);
    const auto turned = [&](std::size_t joint, const Vec3& v) {
      return rotate(posed[joint] * conjugate(bind[joint]), v);
    };
    for (std::size_t k = 0; k < folds.size(); ++k) {
      const Fold& fold = folds[k];
      const Vec3 normal =
          fold_normal(turned(fold.joint, fold.bone), turned(fold.parent, fold.bone), turned(fold.parent, fold.limb));
      for (std::size_t i = 0; i < 3; ++i) {
        weights[f * modifier.component_count + 3 * k + i] = static_cast<float>(normal[i]);
      }
    }
  }
}

}  // namespace bodyopt
