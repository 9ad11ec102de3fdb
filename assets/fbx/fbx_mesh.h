// A mesh of an FBX file, what binds it, and its blend shapes. Units and axes are those of the file.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "assets/fbx/fbx_scene.h"

namespace bodyopt {

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

}  // namespace bodyopt
