// Attached meshes bound to the joints of the skin that they follow, for results that are rigs.
#pragma once

#include "assets/caches/bound_skin.h"
#include "runtime/basis/attachments.h"
#include "runtime/basis/basis.h"

namespace bodyopt::shots {

// Each vertex has the weights of the skin around its anchor, at most four, or is its anchor's joint's. `mesh`: whose
// output vertices are those of `skin`.
BoundSkin bind_attached(const BoundSkin& skin, const MeshTable& mesh, const AttachedMesh& attached);

}  // namespace bodyopt::shots
