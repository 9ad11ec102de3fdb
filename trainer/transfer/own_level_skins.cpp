#include "trainer/transfer/own_level_skins.h"

#include <numbers>

#include "runtime/core/transform.h"
#include "trainer/proxy/level_skins.h"
#include "trainer/proxy/proxy_samples.h"
#include "trainer/train/skinning/linear_blend.h"

namespace bodyopt {
namespace {

constexpr double kTurn = 40 * std::numbers::pi / 180;

Positions bent(const Character& character, const Vec3& axis, double angle) {
  Pose pose = bind_pose(character.skeleton);
  const Quat turn = axis_angle(axis, angle);
  for (std::size_t j = 0; j < pose.joints.size(); ++j) {
    if (character.skeleton.joints[j].parent >= 0) pose.joints[j].rotation = pose.joints[j].rotation * turn;
  }
  return skin_linear(character, pose);
}

}  // namespace

std::vector<TargetSkin> own_level_skins(const Character& character, std::size_t most, std::vector<std::string>& notes) {
  std::vector<Positions> shapes = {character.vertices};
  for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    for (const double angle : {kTurn, -kTurn}) shapes.push_back(bent(character, axis, angle));
  }
  std::vector<TargetSkin> levels;
  for (const LevelSkin& level : level_skins(character, shapes, {}, notes)) {
    if (levels.size() < most) levels.push_back({1e3 * level.error, proxy_character(character, level.skin)});
  }
  return levels;
}

}  // namespace bodyopt
