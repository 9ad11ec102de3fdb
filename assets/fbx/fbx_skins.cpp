#include "assets/fbx/fbx_skins.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace bodyopt {
namespace {

constexpr std::size_t kMostFbxPoints = 1 << 28;  // one mesh may stand in many places

// Bones of meshes, and what the file calls joints, parents before children.
std::set<std::size_t> joints_of(const FbxNodes& nodes, const std::vector<FbxPart>& parts) {
  std::set<std::size_t> joints;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (nodes.model(n).type == "LimbNode") joints.insert(n);
  }
  for (const FbxPart& part : parts) {
    for (const FbxCluster& cluster : part.mesh.clusters) {
      joints.insert(static_cast<std::size_t>(nodes.find(*cluster.bone)));
    }
  }
  return joints;
}

bool stand_alike(const Affine& a, const Affine& b) {
  double size = 0, turned = 0, moved = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      size = std::max(size, std::abs(a.m[i][j]));
      turned = std::max(turned, std::abs(a.m[i][j] - b.m[i][j]));
    }
    moved = std::max(moved, std::abs(a.m[i][3] - b.m[i][3]));
  }
  return turned <= 1e-3 * size && moved <= 1e-4 * size;  // 0.1 mm
}

bool can_share(const FbxSkin& a, const FbxSkin& b) {
  return a.top == b.top && std::ranges::all_of(a.inverse_binds, [&](const auto& joint) {
           const auto found = b.inverse_binds.find(joint.first);
           return found == b.inverse_binds.end() || stand_alike(found->second, joint.second);
         });
}

// Sets to_rest, too: any cluster says how the mesh stood when it was bound, the first is asked.
FbxSkin bind_part(const FbxScene& scene, const FbxNodes& nodes, FbxPart& part) {
  FbxSkin skin;
  const Affine axes = affine_from({{0, 0, 0}, nodes.axes(), {1, 1, 1}});
  bool is_first = true;
  Affine from_rest;  // to the mesh
  for (const FbxCluster& cluster : part.mesh.clusters) {
    const auto joint = static_cast<std::size_t>(nodes.find(*cluster.bone));
    try {
      const Affine bone = cluster.bone_to_world ? axes * nodes.in_metres(*cluster.bone_to_world) : nodes.world(joint);
      const Affine to_bone =
          cluster.mesh_to_bone ? nodes.in_metres(*cluster.mesh_to_bone) : inverse(bone) * nodes.world(part.node);
      if (is_first) {
        part.to_rest = bone * to_bone;
        from_rest = inverse(part.to_rest);
        is_first = false;
      }
      skin.inverse_binds.insert_or_assign(joint, nodes.scaling(nodes.taken_scale(joint)) * to_bone * from_rest);
    } catch (const Error&) {
      scene.fail("'", nodes.model(part.node).name, "' or its bone '", cluster.bone->name,
                 "' was scaled to nothing when they were bound; the FBX file is damaged");
    }
  }
  part.to_rest = part.to_rest * nodes.geometry(part.node);
  return skin;
}

// Joints above those that are bound, as they rest below one another.
void append_joints_above(const FbxNodes& nodes, const std::set<std::size_t>& joints, FbxSkin& skin) {
  const std::map<std::size_t, Affine> bound = skin.inverse_binds;
  for (auto joint = bound.rbegin(); joint != bound.rend(); ++joint) {
    std::size_t n = joint->first;
    Affine inverse_bind = joint->second;
    while (nodes.parent(n) >= 0) {
      inverse_bind = affine_from(nodes.local(n)) * inverse_bind;
      n = static_cast<std::size_t>(nodes.parent(n));
      if (joints.contains(n) && !skin.inverse_binds.emplace(n, inverse_bind).second) break;
    }
  }
  skin.top = skin.inverse_binds.begin()->first;
}

}  // namespace

FbxBody read_fbx_body(const FbxScene& scene, const FbxNodes& nodes) {
  FbxBody body;
  std::set<std::int64_t> skinned;
  std::size_t points = 0;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (nodes.is_lesser_level(n)) continue;
    for (const FbxObject* geometry : scene.into(nodes.model(n).id, "Geometry")) {
      if (geometry->type != "Mesh") continue;
      FbxPart part{n, read_fbx_mesh(scene, *geometry), -1, nodes.scaling(nodes.taken_scale(n)) * nodes.geometry(n)};
      if (part.mesh.triangles.empty()) continue;
      points += part.mesh.points.size() * (1 + part.mesh.shapes.size()) + part.mesh.triangles.size();
      if (points > kMostFbxPoints) scene.fail("its meshes have more than ", kMostFbxPoints, " points and triangles");
      if (!part.mesh.clusters.empty() && !skinned.insert(geometry->id).second) {
        scene.fail("the skinned mesh '", nodes.model(n).name, "' stands in the scene twice; export it once");
      }
      for (const FbxCluster& cluster : part.mesh.clusters) {
        if (nodes.find(*cluster.bone) < 0) {
          scene.fail("'", nodes.model(n).name, "' is bound to '", cluster.bone->name, "', which is not in the scene");
        }
      }
      body.parts.push_back(std::move(part));
    }
  }
  const std::set<std::size_t> joints = joints_of(nodes, body.parts);
  for (FbxPart& part : body.parts) {
    if (part.mesh.clusters.empty()) continue;
    FbxSkin bound = bind_part(scene, nodes, part);
    append_joints_above(nodes, joints, bound);
    const auto shared = std::ranges::find_if(body.skins, [&](const FbxSkin& skin) { return can_share(skin, bound); });
    part.skin = static_cast<int>(shared - body.skins.begin());
    if (shared == body.skins.end()) {
      body.skins.push_back(std::move(bound));
    } else {
      shared->inverse_binds.insert(bound.inverse_binds.begin(), bound.inverse_binds.end());
    }
  }
  return body;
}

}  // namespace bodyopt
