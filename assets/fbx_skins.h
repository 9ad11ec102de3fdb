// The skins of an FBX file: which meshes are bound to one skeleton, and how its joints stood then.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "assets/fbx_nodes.h"
#include "assets/fbx_scene.h"

namespace bodyopt {

// A mesh of an FBX file, what binds it, and its blend shapes. Units and axes are those of the file.

// The points that a bone moves.
struct FbxCluster {
  const FbxObject* bone = nullptr;
  std::vector<std::int64_t> points;
  std::vector<double> weights;                        // as many
  std::optional<Affine> mesh_to_bone, bone_to_world;  // when they were bound
};

struct FbxMesh {
  std::vector<Vec3> points;  // as the file numbers them
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<double> texture;             // R x 2, from the lower left
  std::vector<std::uint32_t> texture_of;   // of each corner of the triangles, among those; empty: none
  std::vector<std::uint32_t> material_of;  // of each triangle, among those of the model
  std::vector<FbxCluster> clusters;        // none: it is not skinned

  struct BlendShape {
    std::vector<Vec3> offsets;  // of every point
    double weight = 0;          // where nothing animates it: 1 is all of it
  };
  std::vector<BlendShape> shapes;
};

// Throws Error(file).
FbxMesh read_fbx_mesh(const FbxScene& scene, const FbxObject& geometry);

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
