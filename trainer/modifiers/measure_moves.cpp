#include "trainer/modifiers/measure_moves.h"

#include <algorithm>

#include "trainer/modifiers/evaluated_skin.h"

namespace bodyopt {
namespace {

// Joints that it turns are as before all modifiers: no two types turn the same.
Pose without(const SkinModifier& modifier, Pose pose) {
  std::fill_n(pose.modifiers.begin() + modifier.first_component, modifier.component_count, 0.0f);
  for (const ModifierTurn& turn : modifier.turns) pose.joints[turn.joint] = pose.own_joints()[turn.joint];
  return pose;
}

}  // namespace

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

}  // namespace bodyopt
