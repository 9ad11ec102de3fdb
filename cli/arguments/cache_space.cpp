#include "cli/arguments/cache_space.h"

namespace bodyopt::cli {

void add_cache_space(CLI::App& verb, CacheSpace& space) {
  add_option(verb, "--unit-out", space.unit,
             "Metres per unit of the cache: the character's own --unit lays it on the mesh of its file")
      ->capture_default_str()
      ->check(above_zero);
  const std::map<std::string, bool> axes = {{"y", false}, {"z", true}};
  add_option(verb, "--axis", space.z_up, "Which axis of the cache is up: y as in glTF, or z as Blender has it")
      ->transform(CLI::CheckedTransformer(axes))
      ->option_text("y|z");
}

}  // namespace bodyopt::cli
