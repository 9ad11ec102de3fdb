#include "assets/gltf/gltf_skin.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "assets/gltf/gltf_skeleton.h"
#include "assets/gltf/gltf_unit.h"
#include "assets/gltf/surface_materials.h"
#include "base/wording.h"

namespace bodyopt {
namespace {

// How often something was repaired, over all primitives.
struct SkinRepairs {
  std::size_t off_sum = 0, negative = 0, morphed = 0, shaped = 0;
  std::vector<std::string> other_meshes;
};

struct SkinPrimitive {
  const tinygltf::Primitive& primitive;
  std::string what;                          // how messages call it
  const std::vector<double>& morph_weights;  // by default, per target; what is not there is 0
  std::vector<std::uint32_t> joints;         // of the skin, per joint of the node's own; empty where it has none
};

int attribute(const tinygltf::Primitive& primitive, const std::string& name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

std::vector<std::uint32_t> element_order(const GltfFile& file, const tinygltf::Primitive& primitive,
                                         std::size_t vertex_count, const std::string& what) {
  std::vector<std::uint32_t> order(vertex_count);
  std::iota(order.begin(), order.end(), 0u);
  if (primitive.indices < 0) return order;
  order = file.indices(primitive.indices, TINYGLTF_TYPE_SCALAR, what + " indices");
  for (const std::uint32_t index : order) {
    if (index >= vertex_count) file.fail(what, ": index ", index, " of ", vertex_count, " vertices");
  }
  return order;
}

void append_triangles(const GltfFile& file, const tinygltf::Primitive& primitive, std::size_t vertex_count,
                      const std::string& what, std::size_t first,
                      std::vector<std::array<std::uint32_t, 3>>& triangles) {
  const std::vector<std::uint32_t> v = element_order(file, primitive, vertex_count, what);
  const auto base = static_cast<std::uint32_t>(first);
  const auto append = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    triangles.push_back({base + a, base + b, base + c});
  };
  switch (primitive.mode) {
    case TINYGLTF_MODE_TRIANGLES:
      if (v.size() % 3 != 0) file.fail(what, ": ", v.size(), " indices are no whole triangles");
      for (std::size_t i = 0; i + 2 < v.size(); i += 3) append(v[i], v[i + 1], v[i + 2]);
      return;
    case TINYGLTF_MODE_TRIANGLE_STRIP:
      for (std::size_t i = 0; i + 2 < v.size(); ++i) append(v[i], v[i + 1 + i % 2], v[i + 2 - i % 2]);
      return;
    case TINYGLTF_MODE_TRIANGLE_FAN:
      for (std::size_t i = 1; i + 1 < v.size(); ++i) append(v[0], v[i], v[i + 1]);
      return;
    default:
      file.fail(what, ": made of points or lines (mode ", primitive.mode, "), expected triangles");
  }
}

// Adds one JOINTS_n/WEIGHTS_n set to the weights of `count` vertices.
void add_weight_set(const GltfFile& file, const SkinPrimitive& part, int set,
                    std::vector<std::vector<JointWeight>>& weights, SkinRepairs& repairs) {
  const auto& [primitive, what, morph_weights, own_joints] = part;
  const std::string suffix = "_" + std::to_string(set);
  const auto joints =
      file.indices(attribute(primitive, "JOINTS" + suffix), TINYGLTF_TYPE_VEC4, what + " JOINTS" + suffix);
  const auto values =
      file.numbers(attribute(primitive, "WEIGHTS" + suffix), TINYGLTF_TYPE_VEC4, what + " WEIGHTS" + suffix);
  if (joints.size() != 4 * weights.size() || values.size() != 4 * weights.size()) {
    file.fail(what, ": JOINTS", suffix, " or WEIGHTS", suffix, " has another count than the positions");
  }
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (values[k] < 0) ++repairs.negative;
    if (values[k] <= 0) continue;
    if (joints[k] >= own_joints.size()) file.fail(what, ": joint ", joints[k], " of ", own_joints.size(), " joints");
    weights[k / 4].push_back({own_joints[joints[k]], values[k]});
  }
}

// Ascending by joint, each joint once, sum 1.
void normalize(std::vector<JointWeight>& weights, SkinRepairs& repairs) {
  std::ranges::sort(weights, {}, &JointWeight::joint);
  double sum = 0;
  std::size_t kept = 0;
  for (const JointWeight& w : weights) {
    sum += w.weight;
    if (kept > 0 && weights[kept - 1].joint == w.joint) {
      weights[kept - 1].weight += w.weight;
    } else {
      weights[kept++] = w;
    }
  }
  weights.resize(kept);
  if (weights.empty()) return;
  if (std::abs(sum - 1) > 1e-3) ++repairs.off_sum;
  for (JointWeight& w : weights) w.weight /= sum;
}

std::size_t vertex_count(const GltfFile& file, const SkinPrimitive& part) {
  return file.numbers(attribute(part.primitive, "POSITION"), TINYGLTF_TYPE_VEC3, part.what + " POSITION").size() / 3;
}

// Offsets of a morph target, a vector per vertex; empty where it moves nothing.
std::vector<Vec3> moved_by(const GltfFile& file, const SkinPrimitive& part, std::size_t target, std::size_t count) {
  const auto& attributes = part.primitive.targets[target];
  const auto position = attributes.find("POSITION");
  if (position == attributes.end()) return {};
  const auto numbers = file.numbers(position->second, TINYGLTF_TYPE_VEC3, part.what + " morph target");
  if (numbers.size() != 3 * count) file.fail(part.what, ": a morph target has another count than the positions");
  std::vector<Vec3> moved;
  for (std::size_t k = 0; k < count; ++k) moved.push_back({numbers[3 * k], numbers[3 * k + 1], numbers[3 * k + 2]});
  return moved;
}

// Morph targets are as strong as they are by default.
std::vector<Vec3> read_positions(const GltfFile& file, const SkinPrimitive& part, SkinRepairs& repairs) {
  const auto numbers = file.numbers(attribute(part.primitive, "POSITION"), TINYGLTF_TYPE_VEC3, part.what + " POSITION");
  std::vector<Vec3> positions;
  for (std::size_t k = 0; k < numbers.size(); k += 3) positions.push_back({numbers[k], numbers[k + 1], numbers[k + 2]});
  bool is_shaped = false;
  for (std::size_t t = 0; t < std::min(part.primitive.targets.size(), part.morph_weights.size()); ++t) {
    if (part.morph_weights[t] == 0) continue;
    is_shaped = true;
    const std::vector<Vec3> moved = moved_by(file, part, t, positions.size());
    for (std::size_t k = 0; k < moved.size(); ++k) positions[k] = positions[k] + part.morph_weights[t] * moved[k];
  }
  if (std::ranges::any_of(positions, [](const Vec3& p) { return !std::isfinite(length(p)); })) {
    file.fail(part.what, ": its morph targets move it out of range");
  }
  if (is_shaped) ++repairs.shaped;
  if (!part.primitive.targets.empty()) ++repairs.morphed;
  return positions;
}

void append_primitive(const GltfFile& file, const SkinPrimitive& part, SkinGeometry& geometry, SkinRepairs& repairs) {
  const std::vector<Vec3> positions = read_positions(file, part, repairs);
  append_triangles(file, part.primitive, positions.size(), part.what, geometry.positions.size(), geometry.triangles);
  geometry.positions.insert(geometry.positions.end(), positions.begin(), positions.end());
  if (part.joints.empty()) return;
  std::vector<std::vector<JointWeight>> weights(positions.size());
  if (attribute(part.primitive, "JOINTS_0") < 0) file.fail(part.what, ": has no skin weights (JOINTS_0, WEIGHTS_0)");
  for (int set = 0; attribute(part.primitive, "JOINTS_" + std::to_string(set)) >= 0; ++set) {
    add_weight_set(file, part, set, weights, repairs);
  }
  for (std::vector<JointWeight>& w : weights) {
    normalize(w, repairs);
    geometry.weights.push_back(std::move(w));
  }
}

void add_notes(const SkinRepairs& repairs, std::vector<std::string>& notes) {
  if (repairs.negative > 0) {
    notes.push_back(count_of(repairs.negative, "negative weight was", "negative weights were") + " set to zero.");
  }
  if (repairs.off_sum > 0) {
    notes.push_back("The weights of " + count_of(repairs.off_sum, "vertex", "vertices") +
                    " did not add up to one (off by more than 0.001); they were normalised.");
  }
  if (repairs.shaped > 0) {
    notes.push_back("Morph targets are taken as strong as they are by default, and do not move.");
  } else if (repairs.morphed > 0) {
    notes.push_back("Morph targets are left out.");
  }
  if (!repairs.other_meshes.empty()) {
    notes.push_back("Meshes that are not on the skin are no part of it: " + list_names(repairs.other_meshes) +
                    " (bodyopt attach adds them).");
  }
}

bool is_on_skin(const tinygltf::Node& node, const std::vector<std::vector<std::uint32_t>>& joints) {
  return node.mesh >= 0 && node.skin >= 0 && !joints[static_cast<std::size_t>(node.skin)].empty();
}

void append_primitives(const GltfFile& file, const tinygltf::Node& node, const std::vector<std::uint32_t>& joints,
                       std::vector<SkinPrimitive>& primitives) {
  const tinygltf::Model& model = file.model();
  if (node.mesh >= std::ssize(model.meshes)) file.fail("a node uses mesh ", node.mesh, " of ", model.meshes.size());
  const tinygltf::Mesh& mesh = model.meshes[static_cast<std::size_t>(node.mesh)];
  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    primitives.push_back({mesh.primitives[p], "mesh " + std::to_string(node.mesh) + " primitive " + std::to_string(p),
                          node.weights.empty() ? mesh.weights : node.weights, joints});
  }
}

// Parts are in output order.
std::vector<SkinPrimitive> skin_primitives(const GltfFile& file, int skin) {
  const std::vector<std::vector<std::uint32_t>> joints = joints_of_skins(file, skin);
  std::vector<SkinPrimitive> primitives;
  for (const tinygltf::Node& node : file.model().nodes) {
    if (is_on_skin(node, joints))
      append_primitives(file, node, joints[static_cast<std::size_t>(node.skin)], primitives);
  }
  return primitives;
}

// Parts of the skin of a character.
std::vector<SkinPrimitive> character_primitives(const GltfFile& file) {
  const int skin = choose_skin(file);
  if (skin < 0) file.fail("has no skinned mesh");
  return skin_primitives(file, skin);
}

// count x 2; empty where the part has none.
std::vector<double> texture_of(const GltfFile& file, const SkinPrimitive& part, const std::string& set,
                               std::size_t count) {
  const int accessor = attribute(part.primitive, set);
  if (accessor < 0) return {};
  std::vector<double> numbers = file.numbers(accessor, TINYGLTF_TYPE_VEC2, part.what + " " + set);
  if (numbers.size() != 2 * count) file.fail(part.what, " ", set, " has another count than the positions");
  return numbers;
}

// count x 3, without alpha; empty where the part has none.
std::vector<double> rgb_of(const GltfFile& file, const SkinPrimitive& part, const std::string& name,
                           std::size_t count) {
  const int accessor = attribute(part.primitive, name);
  if (accessor < 0) return {};
  const std::string what = part.what + " " + name;
  const auto& accessors = file.model().accessors;
  const bool alpha =
      accessor < std::ssize(accessors) && accessors[static_cast<std::size_t>(accessor)].type == TINYGLTF_TYPE_VEC4;
  const std::vector<double> numbers = file.numbers(accessor, alpha ? TINYGLTF_TYPE_VEC4 : TINYGLTF_TYPE_VEC3, what);
  const std::size_t components = alpha ? 4 : 3;
  if (numbers.size() != components * count) file.fail(what, " has another count than the positions");
  std::vector<double> colours;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    if (k % components != 3) colours.push_back(numbers[k]);
  }
  return colours;
}

// `part` among what is there of the parts before it, so many values to a vertex; `otherwise` of parts that have none.
void append_values(const std::vector<double>& part, std::size_t width, std::size_t before, std::size_t count,
                   double otherwise, std::vector<double>& all) {
  if (part.empty() && all.empty()) return;
  all.resize(width * before, otherwise);
  all.insert(all.end(), part.begin(), part.end());
  all.resize(width * (before + count), otherwise);
}

// Reads FBX alone: nothing else vouches for their counts.
int fbx_attribute(const GltfFile& file, const tinygltf::Primitive& primitive, const char* name) {
  return file.is_of_fbx() ? attribute(primitive, name) : -1;
}

// Appends a row for every corner of the triangles so far; the first row is of corners that have none.
void append_rows(const GltfFile& file, const SkinPrimitive& part, SkinLook& look) {
  const std::size_t corners = 3 * look.triangles.size();
  if (const int accessor = fbx_attribute(file, part.primitive, kTextureOf); accessor >= 0) {
    const auto rows = file.numbers(attribute(part.primitive, kTextureRows), TINYGLTF_TYPE_VEC2, part.what + " rows");
    const auto own = file.indices(accessor, TINYGLTF_TYPE_SCALAR, part.what + " corners' rows");
    if (look.texture_of.empty()) {
      look.texture.assign(2, 0.0);
      look.texture_of.assign(corners - own.size(), 0);
    }
    const std::size_t first = look.texture.size() / 2;
    for (const std::uint32_t row : own) {
      if (2 * std::size_t{row} + 1 >= rows.size()) file.fail(part.what, ": a corner has no coordinates");
      look.texture_of.push_back(static_cast<std::uint32_t>(first + row));
    }
    look.texture.insert(look.texture.end(), rows.begin(), rows.end());
  }
  if (!look.texture_of.empty()) look.texture_of.resize(corners, 0);
}

SkinLook look_of(const GltfFile& file, const std::vector<SkinPrimitive>& parts) {
  SkinLook look;
  for (const SkinPrimitive& part : parts) {
    const std::size_t count = vertex_count(file, part);
    append_triangles(file, part.primitive, count, part.what, look.points, look.triangles);
    if (const int accessor = fbx_attribute(file, part.primitive, kMaterialOf); accessor >= 0) {
      const auto own = file.indices(accessor, TINYGLTF_TYPE_SCALAR, part.what + " materials");
      look.materials.insert(look.materials.end(), own.begin(), own.end());
    }
    look.materials.resize(look.triangles.size(), part.primitive.material);
    append_rows(file, part, look);
    const std::string set = "TEXCOORD_" + std::to_string(base_texture_set(file, part.primitive.material));
    const std::vector<double> texture = texture_of(file, part, set, count);
    std::vector<double> colours = rgb_of(file, part, "COLOR_0", count);
    for (double& share : colours) share = std::clamp(share, 0.0, 1.0);
    if (look.texture_of.empty()) append_values(texture, 2, look.points, count, 0, look.texture);
    append_values(colours, 3, look.points, count, 1, look.colours);
    look.points += count;
  }
  return look;
}

}  // namespace

SkinGeometry read_skin_geometry(const GltfFile& file, int skin, std::vector<std::string>& notes) {
  const tinygltf::Model& model = file.model();
  const std::vector<std::vector<std::uint32_t>> joints = joints_of_skins(file, skin);
  SkinGeometry geometry;
  SkinRepairs repairs;
  for (const tinygltf::Node& node : model.nodes) {
    if (node.mesh < 0) continue;
    if (node.mesh >= std::ssize(model.meshes)) file.fail("a node uses mesh ", node.mesh, " of ", model.meshes.size());
    const tinygltf::Mesh& mesh = model.meshes[static_cast<std::size_t>(node.mesh)];
    const std::string& name = node.name.empty() ? mesh.name : node.name;
    if (!is_on_skin(node, joints)) {
      repairs.other_meshes.push_back(name.empty() ? "mesh " + std::to_string(node.mesh) : name);
    } else if (geometry.name.empty()) {
      geometry.name = name;
    }
  }
  for (const SkinPrimitive& part : skin_primitives(file, skin)) append_primitive(file, part, geometry, repairs);
  add_notes(repairs, notes);
  return geometry;
}

SkinGeometry read_node_geometry(const GltfFile& file, std::size_t index, std::vector<std::string>& notes) {
  const tinygltf::Model& model = file.model();
  const tinygltf::Node& node = model.nodes[index];
  if (node.skin >= std::ssize(model.skins)) file.fail("a node uses skin ", node.skin, " of ", model.skins.size());
  SkinGeometry geometry;
  SkinRepairs repairs;
  std::vector<SkinPrimitive> primitives;
  std::vector<std::uint32_t> joints;
  if (node.skin >= 0) joints.resize(model.skins[static_cast<std::size_t>(node.skin)].joints.size());
  std::iota(joints.begin(), joints.end(), 0u);
  append_primitives(file, node, joints, primitives);
  geometry.name = node.name.empty() ? model.meshes[static_cast<std::size_t>(node.mesh)].name : node.name;
  for (const SkinPrimitive& part : primitives) append_primitive(file, part, geometry, repairs);
  add_notes(repairs, notes);
  return geometry;
}

std::vector<Vec3> read_skin_positions(const GltfFile& file, int skin) {
  SkinRepairs unused;
  std::vector<Vec3> all;
  for (const SkinPrimitive& part : skin_primitives(file, skin)) {
    const std::vector<Vec3> positions = read_positions(file, part, unused);
    all.insert(all.end(), positions.begin(), positions.end());
  }
  return all;
}

std::vector<Vec3> read_morph_target(const std::filesystem::path& character, int target, double unit) {
  const GltfFile file(character);
  std::vector<std::string> unused;
  const int skin = choose_skin(file);
  if (skin < 0) file.fail("has no skinned mesh");
  const double metres = file_unit(file, unit, unused);
  Affine rest = read_skin_skeleton(file, skin, metres, unused).rest;
  for (auto& row : rest.m) row[3] = 0;  // of what moves, not of places
  std::vector<Vec3> all;
  std::size_t most = 0;
  for (const SkinPrimitive& part : skin_primitives(file, skin)) {
    const std::size_t count = vertex_count(file, part), first = all.size();
    most = std::max(most, part.primitive.targets.size());
    all.resize(first + count, Vec3{0, 0, 0});
    if (static_cast<std::size_t>(target) >= part.primitive.targets.size()) continue;
    const std::vector<Vec3> moved = moved_by(file, part, static_cast<std::size_t>(target), count);
    for (std::size_t k = 0; k < moved.size(); ++k) all[first + k] = rest * moved[k];
  }
  if (static_cast<std::size_t>(target) >= most) {
    file.fail("has no morph target ", target, "; it has ", count_of(most, "morph target", "morph targets"),
              ", numbered from 0");
  }
  return all;
}

std::vector<double> read_vertex_colours(const std::filesystem::path& character, const std::string& name) {
  const GltfFile file(character);
  std::vector<double> colours;
  std::set<std::string> known;
  for (const SkinPrimitive& part : character_primitives(file)) {
    for (const auto& [key, accessor] : part.primitive.attributes) {
      if (key.starts_with("COLOR_")) known.insert(key);
    }
    const std::size_t count = vertex_count(file, part);
    std::vector<double> own;
    if (name.starts_with("COLOR_")) own = rgb_of(file, part, name, count);
    const auto wrong = std::ranges::find_if_not(own, [](double share) { return share >= 0 && share <= 1; });
    if (wrong != own.end())
      file.fail(part.what, " ", name, ": element ", (wrong - own.begin()) / 3, " is not from 0 to 1");
    own.resize(3 * count, 0.0);
    colours.insert(colours.end(), own.begin(), own.end());
  }
  if (!known.contains(name)) {
    file.fail("its skin has no vertex colours '", name, "'; it has ",
              list_names(std::vector<std::string>(known.begin(), known.end())));
  }
  return colours;
}

SkinLook read_skin_look(const GltfFile& file) { return look_of(file, character_primitives(file)); }

SkinLook read_node_look(const GltfFile& file, std::size_t node) {
  std::vector<SkinPrimitive> primitives;
  append_primitives(file, file.model().nodes[node], {}, primitives);
  return look_of(file, primitives);
}

std::vector<double> read_texture_coordinates(const std::filesystem::path& character) {
  const GltfFile file(character);
  std::vector<double> all;
  for (const SkinPrimitive& part : character_primitives(file)) {
    const std::vector<double> own = texture_of(file, part, "TEXCOORD_0", vertex_count(file, part));
    if (own.empty()) return {};
    all.insert(all.end(), own.begin(), own.end());
  }
  return all;
}

}  // namespace bodyopt
