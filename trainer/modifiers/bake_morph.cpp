// Morph: what a morph target, or a mesh at rest, moves. At rest un-posed space is rest space.
#include "assets/gltf/gltf_skin.h"
#include "base/json_file.h"
#include "geometry/mesh.h"
#include "runtime/basis/character_unit.h"
#include "runtime/core/error.h"
#include "trainer/modifiers/bake_modifier.h"

namespace bodyopt::trainer {
namespace {

Positions target_motion(const BakeInput& input) {
  const std::filesystem::path path = input.folder / input.parameters.name("file");
  const std::vector<Vec3> moved =
      read_morph_target(path, input.parameters.integer("target", 0, 4095), kept_unit(input.basis));
  const MeshTable& mesh = input.basis.mesh;
  if (moved.size() != mesh.output_count()) {
    throw Error(ErrorKind::mismatch, input.place, ": ", path, " has ", moved.size(), " vertices, the character ",
                mesh.output_count(), ": it is of another mesh");
  }
  Positions motion(mesh.vertex_count(), 3);
  for (std::size_t o = moved.size(); o-- > 0;) {  // backwards: the first output vertex stays
    motion.row(mesh.output_vertex[o]) << moved[o][0], moved[o][1], moved[o][2];
  }
  return motion;
}

}  // namespace

BakedModifier bake_morph(const BakeInput& input) {
  if (input.parameters.has("mesh") == input.parameters.has("file")) {
    input.parameters.refuse(
        "needs either 'file' and 'target', a glTF and its morph target, or 'mesh', a shape at rest");
  }
  BakedModifier baked;
  const bool of_mesh = input.parameters.has("mesh");
  baked.components.push_back(of_mesh ? Positions(read_modifier_shape(input, "mesh") - rows_of(input.basis.mesh.rest))
                                     : target_motion(input));
  return baked;
}

}  // namespace bodyopt::trainer
