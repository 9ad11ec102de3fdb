#include "trainer/modifiers/evaluated_skin.h"

#include <algorithm>

#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"

namespace bodyopt {
namespace {

// Joints that it turns are as before all modifiers: no two types turn the same.
Pose without(const SkinModifier& modifier, Pose pose) {
  std::fill_n(pose.modifiers.begin() + modifier.first_component, modifier.component_count, 0.0f);
  for (const ModifierTurn& turn : modifier.turns) pose.joints[turn.joint] = pose.own_joints()[turn.joint];
  return pose;
}

}  // namespace

EvaluatedSkin::EvaluatedSkin(Basis basis) {
  DeviceChoice cpu;
  cpu.name = "cpu";
  deformer_ = std::make_unique<Deformer>(std::move(basis), cpu);
  deformer_->set_normals(false);
}

EvaluatedSkin::~EvaluatedSkin() = default;

std::vector<Positions> EvaluatedSkin::operator()(std::span<const Pose> poses) {
  const std::vector<float> shown = deformer_->evaluate(poses).positions;
  const MeshTable& mesh = deformer_->basis().mesh;
  std::vector<Positions> skins(poses.size(), Positions(mesh.vertex_count(), 3));
  const float* from = shown.data();
  for (Positions& skin : skins) {
    for (const std::uint32_t vertex : mesh.output_vertex) {
      for (int i = 0; i < 3; ++i) skin(vertex, i) = static_cast<double>(*from++);
    }
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

}  // namespace bodyopt
