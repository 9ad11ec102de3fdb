// Relax: what it evens out is found in the mesh itself.
#include "trainer/modifiers/bake_modifier.h"

namespace bodyopt::trainer {

BakedModifier bake_relax(const BakeInput& input) {
  BakedModifier baked;
  baked.components.push_back(Positions::Zero(input.basis.mesh.vertex_count(), 3));
  return baked;
}

}  // namespace bodyopt::trainer
