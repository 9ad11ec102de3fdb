#include "assets/fbx/fbx_node_transform.h"

#include <numbers>

namespace bodyopt {
namespace {

constexpr int kOrders[][3] = {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}, {1, 0, 2}, {2, 0, 1}, {2, 1, 0}};  // first turn first

Quat from_degrees(const Vec3& degrees, int order) {
  Quat turn{0, 0, 0, 1};
  for (const int axis : kOrders[order]) {
    Vec3 direction{};
    direction[static_cast<std::size_t>(axis)] = 1;
    turn = axis_angle(direction, degrees[static_cast<std::size_t>(axis)] * std::numbers::pi / 180) * turn;
  }
  return turn;
}

}  // namespace

FbxNodeTransform::FbxNodeTransform(const FbxScene& scene, const FbxObject& model) {
  const auto vector = [&](const char* name) { return scene.vector(model, name, {}); };
  channels_ = {vector("Lcl Translation"), vector("Lcl Rotation"), scene.vector(model, "Lcl Scaling", {1, 1, 1})};
  rotation_offset_ = vector("RotationOffset");
  rotation_pivot_ = vector("RotationPivot");
  scale_offset_ = vector("ScalingOffset");
  scale_pivot_ = vector("ScalingPivot");
  const double inheritance = scene.number(model, "InheritType", 1);
  if (inheritance == 0) inheritance_ = FbxInheritance::without_shear;
  if (inheritance == 2) inheritance_ = FbxInheritance::without_parent;
  geometry_ = affine_from({vector("GeometricTranslation"), from_degrees(vector("GeometricRotation"), 0),
                           scene.vector(model, "GeometricScaling", {1, 1, 1})});
  // Order and turns before and after are those of limits alone where the file says so.
  if (scene.number(model, "RotationActive", 1) == 0 || scene.number(model, "RotationSpaceForLimitOnly", 0) != 0) return;
  before_ = from_degrees(vector("PreRotation"), 0);
  after_ = conjugate(from_degrees(vector("PostRotation"), 0));
  const double order = scene.number(model, "RotationOrder", 0);
  if (!(order >= 0 && order < 6)) {
    scene.fail("'", model.name, "' has rotation order ", order,
               ", expected 0 to 5 (a spheric one is not read); bring it "
               "by Blender: File > Import > FBX, File > Export > glTF");
  }
  order_ = static_cast<int>(order);
}

JointTransform FbxNodeTransform::at(const FbxChannels& channels) const {
  const Quat turn = before_ * from_degrees(channels.degrees, order_) * after_;
  const Vec3& s = channels.scale;
  const Vec3 scaled_pivot{s[0] * scale_pivot_[0], s[1] * scale_pivot_[1], s[2] * scale_pivot_[2]};
  return {channels.translation + rotation_offset_ + rotation_pivot_ +
              rotate(turn, scale_offset_ + scale_pivot_ - rotation_pivot_ - scaled_pivot),
          normalized(turn), s};
}

}  // namespace bodyopt
