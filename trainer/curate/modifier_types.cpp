#include "assets/json_file.h"
#include "trainer/curate/modifier_type.h"

namespace bodyopt {

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

}  // namespace bodyopt
