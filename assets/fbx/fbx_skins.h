// The skins of an FBX file: which meshes are bound to one skeleton, and how its joints stood then.
#pragma once

#include <map>
#include <vector>

#include "assets/fbx/fbx_mesh.h"
#include "assets/fbx/fbx_nodes.h"

namespace bodyopt {

struct FbxSkin {
  std::map<std::size_t, Affine> inverse_binds;  // by a joint's node: from the world, metres, Y up, to the joint
  std::size_t top = 0;                          // the uppermost of its joints
};

struct FbxPart {
  std::size_t node = 0;
  FbxMesh mesh;
  int skin = -1;
  Affine to_rest;  // from its points in metres to the world as it was bound, or to the node where it has no skin
};

struct FbxBody {
  std::vector<FbxPart> parts;
  std::vector<FbxSkin> skins;
};

// Meshes share a skin where the joints that both have stood alike. Throws Error(file).
FbxBody read_fbx_body(const FbxScene& scene, const FbxNodes& nodes);

}  // namespace bodyopt
