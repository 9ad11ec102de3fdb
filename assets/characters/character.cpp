#include "assets/characters/character.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "assets/gltf/gltf_skeleton.h"
#include "assets/gltf/gltf_skin.h"
#include "assets/gltf/gltf_unit.h"
#include "base/wording.h"
#include "geometry/surface_topology.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "runtime/host/rig.h"

namespace bodyopt {
namespace {

constexpr double kWeldTolerance = 1e-6;  // of the bounding box's diagonal

void bind_weights(const SkinSkeleton& skin, SkinGeometry& geometry, std::vector<std::string>& notes) {
  std::size_t unbound = 0;
  for (std::vector<JointWeight>& weights : geometry.weights) {
    for (JointWeight& w : weights) w.joint = skin.joint_of_skin[w.joint];
    if (weights.empty()) {
      weights.push_back({0, 1});  // parents come first: joint 0 is a root
      ++unbound;
    }
    std::ranges::sort(weights, {}, &JointWeight::joint);
  }
  if (unbound > 0) {
    notes.push_back(count_of(unbound, "vertex has", "vertices have") + " no weights; bound to the root joint '" +
                    skin.skeleton.joints[0].name + "'.");
  }
}

// Applies the joints' common transform to the skin. Mirrored skin keeps its outside outside.
void set_rest(const Affine& rest, SkinGeometry& geometry) {
  for (Vec3& p : geometry.positions) p = rest * p;
  if (determinant(rest) > 0) return;
  for (auto& [a, b, c] : geometry.triangles) std::swap(b, c);
}

// Is the skin, as joints without shear place it, where the file's nodes show it? No
// rotation places skin that some joints turn inside out.
void check_shown(const GltfFile& file, const SkinSkeleton& skin, const SkinGeometry& geometry, double diagonal,
                 std::vector<std::string>& notes) {
  constexpr double kOff = 1e-4;  // of the diagonal
  const std::vector<Affine> placed =
      skinning_matrices(skin.skeleton, transformed(skin.skeleton.joints, &Joint::default_local));
  double most = 0;
  std::set<std::string> mirrored;
  for (std::size_t v = 0; v < geometry.positions.size(); ++v) {
    Vec3 off{0, 0, 0};
    for (const auto& [joint, weight] : geometry.weights[v]) {
      const Vec3& p = geometry.positions[v];
      off = off + weight * (placed[joint] * p - skin.shown[joint] * p);
      if (weight > 1e-3 && determinant(skin.shown[joint]) < -1e-6) mirrored.insert(skin.skeleton.joints[joint].name);
    }
    most = std::max(most, length(off));
  }
  if (!mirrored.empty()) {
    file.fail("joints turn the skin inside out, and others do not: ",
              list_names(std::vector<std::string>(mirrored.begin(), mirrored.end())),
              "; a scale below zero? Apply it to mesh and joints before the export");
  }
  if (!(most > kOff * diagonal)) return;
  notes.push_back("As the file stands, the skin lies up to " + rounded(most) +
                  " m from where it should: its nodes shear it (a scale that is not the same in all directions above "
                  "turned joints), which joints cannot. Apply that scale before the export.");
}

void set_welded(const GltfFile& file, const SkinGeometry& geometry, double tolerance, Character& character) {
  std::optional<Weld> weld = weld_vertices(geometry.positions, geometry.weights, tolerance);
  if (!weld) {
    file.fail(
        "thousands of different vertices lie at one point (within a millionth of the bounding box); is a stray vertex "
        "far away?");
  }
  const std::size_t count = weld->first.size();
  character.vertices.resize(static_cast<Eigen::Index>(count), 3);
  for (std::size_t v = 0; v < count; ++v) {
    const Vec3& p = geometry.positions[weld->first[v]];
    character.vertices.row(static_cast<Eigen::Index>(v)) << p[0], p[1], p[2];
    character.weights.push_back(geometry.weights[weld->first[v]]);
    std::ranges::stable_sort(character.weights.back(), std::greater{}, &JointWeight::weight);
  }
  if (const std::size_t merged = geometry.positions.size() - count; merged > 0) {
    character.notes.push_back(count_of(merged, "seam duplicate", "seam duplicates") +
                              " welded: " + std::to_string(geometry.positions.size()) + " vertices solve as " +
                              std::to_string(count) + ".");
  }
  character.output_vertex = std::move(weld->welded_of);
}

void set_triangles(const GltfFile& file, const SkinGeometry& geometry, Character& character) {
  std::vector<std::array<std::uint32_t, 3>> kept;
  std::vector<bool> used(character.weights.size(), false);
  character.output_triangles = triangles_of(geometry.triangles);
  for (const auto& [a, b, c] : geometry.triangles) {
    const std::uint32_t i = character.output_vertex[a], j = character.output_vertex[b], k = character.output_vertex[c];
    if (i == j || j == k || k == i) continue;
    kept.push_back({i, j, k});
    used[i] = used[j] = used[k] = true;
  }
  if (kept.empty()) file.fail("the skin has no triangle with three different corners");
  character.triangles = triangles_of(kept);
  if (const std::size_t dropped = geometry.triangles.size() - kept.size(); dropped > 0) {
    character.notes.push_back(count_of(dropped, "triangle without area was", "triangles without area were") +
                              " dropped (corners at one point).");
  }
  const auto loose = static_cast<std::size_t>(std::ranges::count(used, false));
  if (loose > 0) character.notes.push_back(count_of(loose, "vertex belongs", "vertices belong") + " to no triangle.");
}

}  // namespace

std::size_t most_weights(const Character& character) {
  std::size_t most = 1;
  for (const auto& weights : character.weights) most = std::max(most, weights.size());
  return most;
}

Positions welded_from_output(const Character& character, const float* output) {
  Positions welded(character.vertices.rows(), 3);
  for (std::size_t o = character.output_vertex.size(); o-- > 0;) {  // backwards: the first output vertex stays
    for (int i = 0; i < 3; ++i) {
      welded(character.output_vertex[o], i) = static_cast<double>(output[3 * o + static_cast<std::size_t>(i)]);
    }
  }
  return welded;
}

std::vector<float> output_from_welded(const Character& character, const Positions& welded) {
  std::vector<float> output;
  output.reserve(3 * character.output_vertex.size());
  for (const std::uint32_t v : character.output_vertex) {
    for (int i = 0; i < 3; ++i) output.push_back(static_cast<float>(welded(v, i)));
  }
  return output;
}

Character read_character(const std::filesystem::path& path, double unit) {
  return read_character(GltfFile(path), unit);
}

Character read_character(const GltfFile& file, double unit) {
  Character character;
  character.notes = file.notes();
  const int skin_index = choose_skin(file);
  if (skin_index < 0) {
    file.fail("has no skinned mesh (a node with both a mesh and a skin); bind the mesh to joints and export the skin");
  }
  const double metres = file_unit(file, unit, character.notes);
  if (unit != 0 || metres != 1) character.unit = metres;
  SkinSkeleton skin = read_skin_skeleton(file, skin_index, metres, character.notes);
  SkinGeometry geometry = read_skin_geometry(file, skin_index, character.notes);
  if (geometry.positions.empty()) file.fail("the skinned mesh has no vertices");
  set_rest(skin.rest, geometry);
  const double diagonal = bounding_box_diagonal(geometry.positions);
  bind_weights(skin, geometry, character.notes);

  check_shown(file, skin, geometry, diagonal, character.notes);
  character.name = geometry.name.empty() ? file.path().stem().string() : geometry.name;
  character.skeleton = std::move(skin.skeleton);
  set_welded(file, geometry, kWeldTolerance * diagonal, character);
  set_triangles(file, geometry, character);
  return character;
}

bool has_skin(const std::filesystem::path& path) { return choose_skin(GltfFile(path)) >= 0; }

}  // namespace bodyopt
