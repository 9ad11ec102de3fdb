#include "assets/json_file.h"
#include "trainer/curate/modifier_type.h"

namespace bodyopt {

std::span<const ModifierType> modifier_types() {
  using Effect = ModifierType::Effect;
  static const std::vector<ModifierType> types = {
      {"sculpt",
       "an artist's meshes of single frames, spread to poses nearby",
       Effect::shape,
       false,
       false,
       {"sculpts", "spread_degrees", "joints"},
       prepare_sculpt},
      {"smooth", "evens out the displacement over the skin", Effect::shape, true, true, {"radius_mm"}, prepare_smooth},
      {"relax",
       "evens it out along the skin only: the silhouette stays",
       Effect::shape,
       true,
       true,
       {"radius_mm"},
       prepare_relax},
      {"consistency",
       "makes the shapes of like poses agree",
       Effect::shape,
       true,
       false,
       {"degrees", "smooth_mm", "cap_mm", "iterations"},
       prepare_consistency},
      {"despike",
       "puts back vertices that fly off in single frames of a motion",
       Effect::shape,
       true,
       true,
       {"limit_mm"},
       prepare_despike},
      {"volume",
       "gives back the volume that the skin lost against rest",
       Effect::shape,
       true,
       false,
       {"cap_mm"},
       prepare_volume},
      {"blend",
       "towards the shapes of another cache",
       Effect::shape,
       false,
       false,
       {"cache", "take", "frames"},
       prepare_blend},
      {"detail",
       "the fine detail of one frame, in others",
       Effect::shape,
       true,
       true,
       {"take", "frame", "radius_mm"},
       prepare_detail},
      {"inflate", "the skin along its normals", Effect::shape, true, false, {"distance_mm"}, prepare_inflate},
      {"symmetry", "adds every frame's mirror image, pose and shape", Effect::mirror, false, false, {}, nullptr},
      {"drop", "leaves frames out", Effect::drop, false, false, {}, nullptr},
      {"weight", "how much frames count in training", Effect::weight, false, false, {"weight"}, nullptr},
      {"freeze", "frames or parts that no automatic modifier changes", Effect::freeze, false, false, {}, nullptr},
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
