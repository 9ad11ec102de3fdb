// Binds a mesh to a skin: every connected piece of it follows the skin, or is fixed to a spot of it, or to a joint.
#pragma once

#include "runtime/basis/attachments.h"
#include "trainer/attach/loose_meshes.h"
#include "trainer/attach/rest_skin.h"

namespace bodyopt {

enum class AttachMode {
  automatic,
  skin,   // every vertex rides on the point of the skin nearest to it: clothes
  piece,  // rigid, on the skin it is nearest to: nails, buttons
  joint,  // rigid, with a joint: eyes, teeth, props
};

struct AttachOptions {
  AttachMode mode = AttachMode::automatic;
  int joint = -1;   // for AttachMode::joint; -1: that which moves the skin nearest to a piece
  double unit = 1;  // metres per unit that the mesh was read with, for messages
};

// What is done by itself, per piece. A mesh that hangs on a joint is fixed to it. A small piece (1/20 of the character
// at most, corner to corner) that lies on the outside of the skin is fixed to the skin; one inside it, or in a hollow
// of it, to the joint. Of large ones what lies along the skin (nine tenths of it no further off than 1/40 of the
// character), or is itself skinned to several joints, follows the skin; the others are fixed to the joint. The joint is
// that of the mesh's own weights, or the one that moves most of the skin nearest to the piece.
// Throws Error(mismatch) where the mesh is nowhere near the skin, Error(file) where it has no area.
AttachedMesh bind_mesh(const LooseMesh& mesh, const RestSkin& skin, const AttachOptions& options);

}  // namespace bodyopt
