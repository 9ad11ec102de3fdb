#include "assets/gltf/fbx_glb.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "assets/fbx/fbx_skins.h"
#include "assets/gltf/fbx_materials.h"
#include "assets/gltf/gltf_skeleton.h"
#include "assets/gltf/gltf_skin.h"
#include "assets/gltf/gltf_write.h"

namespace bodyopt {
namespace {

constexpr std::size_t kMostFbxKeys = 1 << 24;

Json json_of(const FbxNodes& nodes, std::size_t n) {
  const JointTransform local = nodes.local(n);
  return {{"name", nodes.model(n).name},
          {"translation", local.translation},
          {"rotation", local.rotation},
          {"scale", local.scale}};
}

void add_nodes(const FbxNodes& nodes, GlbWriter& glb) {
  Json& all = glb.root["nodes"];
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    all.push_back(json_of(nodes, n));
    const int parent = nodes.parent(n);
    Json& list = parent < 0 ? glb.root["scenes"][0]["nodes"] : all[static_cast<std::size_t>(parent)]["children"];
    list.push_back(n);
  }
}

void append_floats(const FbxScene& scene, const Vec3& vector, std::vector<float>& floats) {
  for (const double number : vector) {
    floats.push_back(static_cast<float>(number));
    if (!std::isfinite(floats.back())) scene.fail("a mesh reaches beyond all numbers; the FBX file is damaged");
  }
}

void add_skins(const FbxScene& scene, const FbxBody& body, GlbWriter& glb) {
  for (const FbxSkin& skin : body.skins) {
    std::vector<float> columns;
    Json joints;
    for (const auto& [joint, inverse_bind] : skin.inverse_binds) {
      joints.push_back(joint);
      for (std::size_t column = 0; column < 4; ++column) {
        append_floats(scene, {inverse_bind.m[0][column], inverse_bind.m[1][column], inverse_bind.m[2][column]},
                      columns);
        columns.push_back(column == 3 ? 1 : 0);
      }
    }
    const std::size_t binds = glb.add(columns, "MAT4", GlbTarget::none);
    glb.root["skins"].push_back({{"joints", joints}, {"inverseBindMatrices", binds}});
  }
}

void add_weights(const FbxScene& scene, const FbxNodes& nodes, const FbxPart& part, const FbxSkin& skin, GlbWriter& glb,
                 Json& attributes) {
  std::vector<GlbWriter::VertexWeights> bound(part.mesh.points.size());
  std::size_t most = 1;
  for (const FbxCluster& cluster : part.mesh.clusters) {
    const auto found = skin.inverse_binds.find(static_cast<std::size_t>(nodes.find(*cluster.bone)));
    const auto joint = static_cast<std::uint16_t>(std::distance(skin.inverse_binds.begin(), found));
    for (std::size_t k = 0; k < cluster.points.size(); ++k) {
      auto& here = bound[static_cast<std::size_t>(cluster.points[k])];
      if (cluster.weights[k] != 0) here.emplace_back(joint, static_cast<float>(cluster.weights[k]));
      most = std::max(most, here.size());
    }
  }
  if (most > 1024) scene.fail("a point has ", most, " weights; the FBX file is damaged or hostile");
  glb.add_weights(bound, most, attributes);
}

std::size_t add_vectors(const FbxScene& scene, const std::vector<Vec3>& vectors, const Affine& turn, GlbWriter& glb) {
  std::vector<float> floats;
  for (const Vec3& vector : vectors) append_floats(scene, turn * vector, floats);
  return glb.add(floats, "VEC3", GlbTarget::vertices);
}

// Adds what glTF has no attributes for: coordinates in images of the triangles' corners, apart from the points, and a
// material of each triangle.
void add_look(const FbxScene& scene, const FbxPart& part, std::int64_t model, const std::vector<std::size_t>& order,
              const std::map<std::int64_t, std::size_t>& numbers, GlbWriter& glb, Json& attributes) {
  const std::vector<const FbxObject*> materials = scene.into(model, "Material");
  std::vector<std::uint32_t> material_of, texture_of;
  for (const std::uint32_t own : part.mesh.material_of) {
    if (materials.empty()) break;
    material_of.push_back(static_cast<std::uint32_t>(numbers.at(materials[own < materials.size() ? own : 0]->id)));
  }
  if (!material_of.empty()) attributes[kMaterialOf] = glb.add(material_of, "SCALAR", GlbTarget::none);
  if (part.mesh.texture_of.empty()) return;
  for (std::size_t c = 0; c < part.mesh.texture_of.size(); ++c) {
    texture_of.push_back(part.mesh.texture_of[c - c % 3 + order[c % 3]]);
  }
  std::vector<float> rows;
  for (std::size_t k = 0; k + 1 < part.mesh.texture.size(); k += 2) {
    rows.insert(rows.end(),
                {static_cast<float>(part.mesh.texture[k]), static_cast<float>(1 - part.mesh.texture[k + 1])});
  }
  attributes[kTextureRows] = glb.add(rows, "VEC2", GlbTarget::none);
  attributes[kTextureOf] = glb.add(texture_of, "SCALAR", GlbTarget::none);
}

void add_part(const FbxScene& scene, const FbxNodes& nodes, const FbxBody& body, const FbxPart& part,
              const std::map<std::int64_t, std::size_t>& materials, GlbWriter& glb) {
  Affine to_rest = part.to_rest;
  for (auto& row : to_rest.m) {
    for (std::size_t column = 0; column < 3; ++column) row[column] *= nodes.unit();
  }
  Json primitive = {{"attributes", {{"POSITION", add_vectors(scene, part.mesh.points, to_rest, glb)}}}};
  if (part.skin >= 0) {
    add_weights(scene, nodes, part, body.skins[static_cast<std::size_t>(part.skin)], glb, primitive["attributes"]);
  }
  std::vector<std::uint32_t> corners;
  const bool is_mirrored = determinant(to_rest) < 0;
  for (const auto& [a, b, c] : part.mesh.triangles)
    corners.insert(corners.end(), {a, is_mirrored ? c : b, is_mirrored ? b : c});
  primitive["indices"] = glb.add(corners, "SCALAR", GlbTarget::indices);
  const std::vector<std::size_t> order =
      is_mirrored ? std::vector<std::size_t>{0, 2, 1} : std::vector<std::size_t>{0, 1, 2};
  add_look(scene, part, nodes.model(part.node).id, order, materials, glb, primitive["attributes"]);
  Json mesh = {{"name", nodes.model(part.node).name}};
  for (auto& row : to_rest.m) row[3] = 0;
  for (const FbxMesh::BlendShape& shape : part.mesh.shapes) {
    primitive["targets"].push_back({{"POSITION", add_vectors(scene, shape.offsets, to_rest, glb)}});
    mesh["weights"].push_back(shape.weight);
  }
  mesh["primitives"].push_back(primitive);
  glb.root["meshes"].push_back(mesh);
  Json& node = glb.root["nodes"][part.node];
  node["mesh"] = glb.root["meshes"].size() - 1;
  if (part.skin >= 0) node["skin"] = part.skin;
}

void add_node_motion(const FbxScene& scene, const FbxNodes& nodes, std::size_t n, const FbxMotion& motion,
                     std::size_t& keys_left, GlbWriter& glb, Json& animation) {
  const std::vector<double> times = motion.times(nodes.movers(n));
  const FbxKeys keys = straight_keys(
      times, [&](double seconds) { return nodes.local(n, &motion, seconds); }, keys_left);
  if (keys.times.size() >= keys_left) scene.fail("the animations have more than ", kMostFbxKeys, " keys");
  keys_left -= keys.times.size();
  std::vector<float> translations, rotations, scales;
  for (const JointTransform& local : keys.locals) {
    append_floats(scene, local.translation, translations);
    rotations.insert(rotations.end(), local.rotation.begin(), local.rotation.end());
    append_floats(scene, local.scale, scales);
  }
  const std::size_t input =
      glb.add(std::vector<float>(keys.times.begin(), keys.times.end()), "SCALAR", GlbTarget::none);
  const auto add = [&](const char* path, const std::vector<float>& values, const char* type) {
    add_channel(input, glb.add(values, type, GlbTarget::none), n, path, animation);
  };
  add("translation", translations, "VEC3");
  add("rotation", rotations, "VEC4");
  add("scale", scales, "VEC3");
}

void add_animations(const FbxScene& scene, const FbxNodes& nodes, GlbWriter& glb) {
  std::size_t keys_left = kMostFbxKeys;
  for (const FbxObject& stack : scene.objects()) {
    if (stack.kind != "AnimationStack") continue;
    const FbxMotion motion(scene, stack);
    Json animation = {{"name", stack.name}, {"channels", Json::array()}, {"samplers", Json::array()}};
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      if (std::ranges::any_of(nodes.movers(n), [&](const FbxObject* model) { return motion.is_animated(*model); })) {
        add_node_motion(scene, nodes, n, motion, keys_left, glb, animation);
      }
    }
    if (animation["channels"].empty()) continue;
    if (motion.moves_shapes()) {  // says so; its numbers are not read
      animation["channels"].push_back({{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}});
    }
    glb.root["animations"].push_back(animation);
  }
}

}  // namespace

std::string glb_of_fbx(const std::filesystem::path& path, std::string_view bytes) {
  const FbxScene scene(path, bytes);
  const FbxNodes nodes(scene);
  if (nodes.size() > 0xFFFF) scene.fail("has ", nodes.size(), " nodes, expected at most 65,535");
  GlbWriter glb;
  add_nodes(nodes, glb);
  const FbxBody body = read_fbx_body(scene, nodes);
  add_skins(scene, body, glb);
  const std::map<std::int64_t, std::size_t> materials = add_fbx_materials(scene, path, glb);
  for (const FbxPart& part : body.parts) add_part(scene, nodes, body, part, materials, glb);
  add_animations(scene, nodes, glb);
  return glb.bytes(path);
}

}  // namespace bodyopt
