#include "trainer/modifiers/evaluated_skin.h"

#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"

namespace bodyopt {

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

}  // namespace bodyopt
