#include "assets/gltf_skin.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "assets/gltf_nodes.h"
#include "assets/gltf_skeleton.h"
#include "assets/wording.h"

namespace bodyopt {
namespace {

// How often something was repaired, over all primitives.
struct SkinRepairs {
  std::size_t off_sum = 0, negative = 0, unskinned_meshes = 0, morphed = 0;
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
                      const std::string& what, SkinGeometry& geometry) {
  const std::vector<std::uint32_t> v = element_order(file, primitive, vertex_count, what);
  const auto base = static_cast<std::uint32_t>(geometry.positions.size());
  const auto append = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    geometry.triangles.push_back({base + a, base + b, base + c});
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
void add_weight_set(const GltfFile& file, const tinygltf::Primitive& primitive, int set, std::size_t joint_count,
                    const std::string& what, std::vector<std::vector<JointWeight>>& weights, SkinRepairs& repairs) {
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
    if (joints[k] >= joint_count) file.fail(what, ": joint ", joints[k], " of ", joint_count, " joints");
    weights[k / 4].push_back({joints[k], values[k]});
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

// Returns the number of vertices.
std::size_t append_primitive(const GltfFile& file, const tinygltf::Primitive& primitive, const std::string& what,
                             SkinGeometry& geometry, SkinRepairs& repairs) {
  const auto numbers = file.numbers(attribute(primitive, "POSITION"), TINYGLTF_TYPE_VEC3, what + " POSITION");
  const std::size_t count = numbers.size() / 3;
  append_triangles(file, primitive, count, what, geometry);
  for (std::size_t i = 0; i < count; ++i)
    geometry.positions.push_back({numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]});
  if (!primitive.targets.empty()) ++repairs.morphed;
  return count;
}

void append_weights(const GltfFile& file, const tinygltf::Primitive& primitive, std::size_t count,
                    std::size_t joint_count, const std::string& what, SkinGeometry& geometry, SkinRepairs& repairs) {
  std::vector<std::vector<JointWeight>> weights(count);
  if (attribute(primitive, "JOINTS_0") < 0) file.fail(what, ": has no skin weights (JOINTS_0, WEIGHTS_0)");
  for (int set = 0; attribute(primitive, "JOINTS_" + std::to_string(set)) >= 0; ++set) {
    add_weight_set(file, primitive, set, joint_count, what, weights, repairs);
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
  if (repairs.morphed > 0) notes.push_back("Morph targets are left out.");
  if (repairs.unskinned_meshes > 0) {
    notes.push_back(
        count_of(repairs.unskinned_meshes, "mesh that is not on the skin is", "meshes that are not on the skin are") +
        " no part of it (bodyopt attach: what rides on the skin).");
  }
}

struct SkinPrimitive {
  const tinygltf::Primitive& primitive;
  std::string what;  // how messages call it
};

void append_primitives(const GltfFile& file, const tinygltf::Node& node, std::vector<SkinPrimitive>& primitives) {
  const tinygltf::Model& model = file.model();
  if (node.mesh >= std::ssize(model.meshes)) file.fail("a node uses mesh ", node.mesh, " of ", model.meshes.size());
  const tinygltf::Mesh& mesh = model.meshes[static_cast<std::size_t>(node.mesh)];
  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    primitives.push_back({mesh.primitives[p], "mesh " + std::to_string(node.mesh) + " primitive " + std::to_string(p)});
  }
}

// In output order.
std::vector<SkinPrimitive> skin_primitives(const GltfFile& file, int skin) {
  std::vector<SkinPrimitive> primitives;
  for (const tinygltf::Node& node : file.model().nodes) {
    if (node.mesh >= 0 && node.skin == skin) append_primitives(file, node, primitives);
  }
  return primitives;
}

// count x 3. With alpha or without.
std::vector<double> colours_of(const GltfFile& file, int accessor, std::size_t count, const std::string& what) {
  const auto& accessors = file.model().accessors;
  const bool alpha = accessor >= 0 && accessor < std::ssize(accessors) &&
                     accessors[static_cast<std::size_t>(accessor)].type == TINYGLTF_TYPE_VEC4;
  const std::vector<double> numbers = file.numbers(accessor, alpha ? TINYGLTF_TYPE_VEC4 : TINYGLTF_TYPE_VEC3, what);
  const std::size_t components = alpha ? 4 : 3;
  if (numbers.size() != components * count) file.fail(what, " has another count than the positions");
  std::vector<double> colours;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    if (k % components == 3) continue;
    if (!(numbers[k] >= 0 && numbers[k] <= 1)) file.fail(what, ": element ", k / components, " is not from 0 to 1");
    colours.push_back(numbers[k]);
  }
  return colours;
}

}  // namespace

SkinGeometry read_skin_geometry(const GltfFile& file, int skin, std::vector<std::string>& notes) {
  const tinygltf::Model& model = file.model();
  const std::size_t joint_count = model.skins[static_cast<std::size_t>(skin)].joints.size();
  SkinGeometry geometry;
  SkinRepairs repairs;
  for (const tinygltf::Node& node : model.nodes) {
    if (node.mesh < 0) continue;
    if (node.skin != skin) {
      ++repairs.unskinned_meshes;
      continue;
    }
    const tinygltf::Mesh& mesh = model.meshes[static_cast<std::size_t>(node.mesh)];
    if (geometry.name.empty()) geometry.name = node.name.empty() ? mesh.name : node.name;
  }
  for (const auto& [primitive, what] : skin_primitives(file, skin)) {
    const std::size_t count = append_primitive(file, primitive, what, geometry, repairs);
    append_weights(file, primitive, count, joint_count, what, geometry, repairs);
  }
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
  append_primitives(file, node, primitives);
  geometry.name = node.name.empty() ? model.meshes[static_cast<std::size_t>(node.mesh)].name : node.name;
  for (const auto& [primitive, what] : primitives) {
    const std::size_t count = append_primitive(file, primitive, what, geometry, repairs);
    if (node.skin < 0) continue;
    const std::size_t joints = model.skins[static_cast<std::size_t>(node.skin)].joints.size();
    append_weights(file, primitive, count, joints, what, geometry, repairs);
  }
  add_notes(repairs, notes);
  return geometry;
}

std::vector<Vec3> read_morph_target(const std::filesystem::path& character, int target, double unit) {
  const GltfFile file(character);
  std::vector<std::string> unused;
  const int skin = choose_skin(file, unused);
  if (skin < 0) file.fail("has no skinned mesh");
  const double metres = unit > 0 ? unit : 1, scale = metres * read_skin_skeleton(file, skin, metres, unused).rest_scale;
  std::vector<Vec3> moved;
  std::size_t most = 0;
  for (const auto& [primitive, what] : skin_primitives(file, skin)) {
    const std::size_t count =
        file.numbers(attribute(primitive, "POSITION"), TINYGLTF_TYPE_VEC3, what + " POSITION").size() / 3;
    most = std::max(most, primitive.targets.size());
    const std::size_t first = moved.size();
    moved.resize(first + count, Vec3{0, 0, 0});
    if (static_cast<std::size_t>(target) >= primitive.targets.size()) continue;
    const auto& attributes = primitive.targets[static_cast<std::size_t>(target)];
    const auto position = attributes.find("POSITION");
    if (position == attributes.end()) continue;
    const auto numbers = file.numbers(position->second, TINYGLTF_TYPE_VEC3, what + " morph target");
    if (numbers.size() != 3 * count) file.fail(what, ": a morph target has another count than the positions");
    for (std::size_t k = 0; k < count; ++k) {
      moved[first + k] = scale * Vec3{numbers[3 * k], numbers[3 * k + 1], numbers[3 * k + 2]};
    }
  }
  if (static_cast<std::size_t>(target) >= most) {
    file.fail("has no morph target ", target, "; it has ", count_of(most, "morph target", "morph targets"),
              ", numbered from 0");
  }
  return moved;
}

std::vector<double> read_vertex_colours(const std::filesystem::path& character, const std::string& name) {
  const GltfFile file(character);
  std::vector<std::string> unused;
  std::vector<double> colours;
  std::set<std::string> known;
  const int skin = choose_skin(file, unused);
  if (skin < 0) file.fail("has no skinned mesh");
  for (const auto& [primitive, what] : skin_primitives(file, skin)) {
    for (const auto& [key, accessor] : primitive.attributes) {
      if (key.starts_with("COLOR_")) known.insert(key);
    }
    const std::size_t count =
        file.numbers(attribute(primitive, "POSITION"), TINYGLTF_TYPE_VEC3, what + " POSITION").size() / 3;
    if (name.starts_with("COLOR_") && attribute(primitive, name) >= 0) {
      const std::vector<double> own = colours_of(file, attribute(primitive, name), count, what + " " + name);
      colours.insert(colours.end(), own.begin(), own.end());
    } else {
      colours.resize(colours.size() + 3 * count, 0.0);
    }
  }
  if (!known.contains(name)) {
    file.fail("its skin has no vertex colours '", name, "'; it has ",
              list_names(std::vector<std::string>(known.begin(), known.end())));
  }
  return colours;
}

std::vector<double> read_texture_coordinates(const std::filesystem::path& character) {
  const GltfFile file(character);
  std::vector<std::string> unused;
  std::vector<double> all;
  const int skin = choose_skin(file, unused);
  if (skin < 0) file.fail("has no skinned mesh");
  for (const auto& [primitive, what] : skin_primitives(file, skin)) {
    if (attribute(primitive, "TEXCOORD_0") < 0) return {};
    const std::size_t count =
        file.numbers(attribute(primitive, "POSITION"), TINYGLTF_TYPE_VEC3, what + " POSITION").size() / 3;
    const std::vector<double> own =
        file.numbers(attribute(primitive, "TEXCOORD_0"), TINYGLTF_TYPE_VEC2, what + " TEXCOORD_0");
    if (own.size() != 2 * count) file.fail(what, " TEXCOORD_0 has another count than the positions");
    all.insert(all.end(), own.begin(), own.end());
  }
  return all;
}

}  // namespace bodyopt
