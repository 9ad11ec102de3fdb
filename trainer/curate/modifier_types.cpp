#include "trainer/curate/modifier_types.h"

#include <utility>

#include "base/json_file.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::trainer {

using Eigen::Index;

UnposedSpace::UnposedSpace(const Character& character) : UnposedSpace(character, build_ddm_basis(character, {})) {}

UnposedSpace::UnposedSpace(const Character& character, Basis ddm)
    : basis_(std::move(ddm)), order_(morton_order(character.vertices)) {}

UnposedSpace::Frame UnposedSpace::frame(const Pose& pose) const {
  const std::vector<VertexPlacement> placements = ddm_placements(basis_, pose);
  Frame frame;
  frame.placements_.resize(order_.size());
  for (std::size_t k = 0; k < order_.size(); ++k) frame.placements_[order_[k]] = placements[k];
  return frame;
}

Positions UnposedSpace::Frame::offsets(const Positions& shape) const {
  Positions result(shape.rows(), 3);
  for (Index v = 0; v < shape.rows(); ++v) {
    result.row(v) = placements_[static_cast<std::size_t>(v)].unposed(shape.row(v));
  }
  return result;
}

Positions UnposedSpace::Frame::shape(const Positions& offsets) const {
  Positions result(offsets.rows(), 3);
  for (Index v = 0; v < offsets.rows(); ++v) {
    result.row(v) = placements_[static_cast<std::size_t>(v)].posed(offsets.row(v));
  }
  return result;
}

std::span<const ModifierType> modifier_types() {
  using Effect = ModifierType::Effect;
  static const std::vector<ModifierType> types = {
      {"sculpt",
       "an artist's meshes of single frames, spread to poses nearby",
       {"sculpts", "spread_degrees", "joints"},
       prepare_sculpt},
      {"smooth", "evens out the displacement over the skin", {"radius_mm"}, prepare_smooth, true, true},
      {"relax", "evens it out along the skin only: the silhouette stays", {"radius_mm"}, prepare_relax, true, true},
      {"consistency",
       "makes the shapes of like poses agree",
       {"degrees", "smooth_mm", "cap_mm", "iterations"},
       prepare_consistency,
       true},
      {"despike",
       "puts back vertices that fly off in single frames of a motion",
       {"limit_mm"},
       prepare_despike,
       true,
       true},
      {"volume", "gives back the volume that the skin lost against rest", {"cap_mm"}, prepare_volume, true},
      {"blend", "towards the shapes of another cache", {"cache", "take", "frames"}, prepare_blend},
      {"detail", "the fine detail of one frame, in others", {"take", "frame", "radius_mm"}, prepare_detail, true, true},
      {"inflate", "the skin along its normals", {"distance_mm"}, prepare_inflate, true},
      {"symmetry", "adds every frame's mirror image, pose and shape", {}, nullptr, false, false, Effect::mirror},
      {"drop", "leaves frames out", {}, nullptr, false, false, Effect::drop},
      {"weight", "how much frames count in training", {"weight"}, nullptr, false, false, Effect::weight},
      {"freeze", "frames or parts that no automatic modifier changes", {}, nullptr, false, false, Effect::freeze},
  };
  return types;
}

const ModifierType* find_modifier_type(const std::string& name) {
  for (const ModifierType& type : modifier_types()) {
    if (type.name == name) return &type;
  }
  return nullptr;
}

double parameter(const ModifierInput& input, const char* key, double usual, double low, double high) {
  return input.parameters.has(key) ? input.parameters.number(key, low, high) : usual;
}

}  // namespace bodyopt::trainer
