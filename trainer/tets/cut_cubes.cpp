#include "trainer/tets/cut_cubes.h"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "base/disjoint_sets.h"
#include "base/parallel.h"

namespace bodyopt {
namespace {

// Calls visit(cube, axis, its index, that of the next cube along the axis) for neighbours that are filled.
template <typename Visit>
void for_neighbours(const VoxelGrid& grid, const std::vector<Voxel>& voxels, const Visit& visit) {
  Eigen::Vector3i cube;
  for (cube[2] = 0; cube[2] < grid.count[2]; ++cube[2]) {
    for (cube[1] = 0; cube[1] < grid.count[1]; ++cube[1]) {
      for (cube[0] = 0; cube[0] < grid.count[0]; ++cube[0]) {
        const std::size_t index = grid.index(cube);
        if (voxels[index] == Voxel::outside) continue;
        for (int axis = 0; axis < 3; ++axis) {
          const Eigen::Vector3i next = cube + Eigen::Vector3i::Unit(axis);
          if (next[axis] == grid.count[axis] || voxels[grid.index(next)] == Voxel::outside) continue;
          visit(cube, axis, index, grid.index(next));
        }
      }
    }
  }
}

struct Neighbours {
  Eigen::Vector3i cube;
  int axis;
  std::size_t index, next;
};

// Those between which skin may lie.
std::vector<Neighbours> neighbours_at_skin(const VoxelGrid& grid, const std::vector<Voxel>& voxels) {
  std::vector<Neighbours> result;
  for_neighbours(grid, voxels, [&](const Eigen::Vector3i& cube, int axis, std::size_t index, std::size_t next) {
    if (voxels[index] != Voxel::surface && voxels[next] != Voxel::surface) return;
    result.push_back({cube, axis, index, next});
  });
  return result;
}

std::uint32_t main_joint(const SkinPoint& point, const SkinWeights& weights) {
  Eigen::Index corner = 0;
  point.weights.maxCoeff(&corner);
  return weights[point.vertices[static_cast<std::size_t>(corner)]].front().joint;
}

std::uint8_t bit(int axis) { return static_cast<std::uint8_t>(1 << axis); }

// Where two parts touch: their lowest cubes, and the joints of the skin on either side.
using Contact = std::array<std::size_t, 4>;

// Takes back cuts where things hang together by nothing else: of all that a part touches, those from the one joint's
// skin that it touches most (a maximum spanning forest, Kruskal 1956), so that a tooth between two jaws does not join
// them. joint_at(index): the main joint of the skin at a cube of `neighbours`.
void keep_whole(const VoxelGrid& grid, const std::vector<Voxel>& voxels, const std::vector<Neighbours>& neighbours,
                const std::function<std::uint32_t(std::size_t)>& joint_at, std::vector<std::uint8_t>& cuts) {
  DisjointSets parts(grid.total());
  for_neighbours(grid, voxels, [&](const Eigen::Vector3i&, int axis, std::size_t index, std::size_t next) {
    if ((cuts[index] & bit(axis)) == 0) parts.join(index, next);
  });
  const auto contact_at = [&](const Neighbours& faces) -> Contact {
    using Side = std::pair<std::size_t, std::uint32_t>;
    const auto [a, b] = std::minmax(
        {Side(parts.lowest(faces.index), joint_at(faces.index)), Side(parts.lowest(faces.next), joint_at(faces.next))});
    return {a.first, b.first, a.second, b.second};
  };
  std::map<Contact, std::size_t> touching;  // in so many faces
  for (const Neighbours& faces : neighbours) {
    if ((cuts[faces.index] & bit(faces.axis)) != 0) ++touching[contact_at(faces)];
  }
  std::vector<std::pair<Contact, std::size_t>> most_first(touching.begin(), touching.end());
  std::stable_sort(most_first.begin(), most_first.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  DisjointSets whole = parts;
  std::set<Contact> held;
  for (const auto& [contact, count] : most_first) {
    if (whole.lowest(contact[0]) == whole.lowest(contact[1])) continue;
    whole.join(contact[0], contact[1]);
    held.insert(contact);
  }
  for (const Neighbours& faces : neighbours) {
    if ((cuts[faces.index] & bit(faces.axis)) == 0 || !held.contains(contact_at(faces))) continue;
    cuts[faces.index] = static_cast<std::uint8_t>(cuts[faces.index] & ~bit(faces.axis));
  }
}

}  // namespace

CubeCuts::CubeCuts(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights)
    : weights_(weights), nearest_(vertices, triangles), apart_(vertices, triangles, weights) {}

std::vector<std::uint8_t> CubeCuts::in(const VoxelGrid& grid, const std::vector<Voxel>& voxels) const {
  const std::vector<Neighbours> neighbours = neighbours_at_skin(grid, voxels);
  std::vector<int> place(grid.total(), -1);
  std::vector<Eigen::Vector3i> cubes;
  const auto add = [&](const Eigen::Vector3i& cube) {
    int& at = place[grid.index(cube)];
    if (at >= 0) return;
    at = static_cast<int>(cubes.size());
    cubes.push_back(cube);
  };
  for (const Neighbours& pair : neighbours) {
    add(pair.cube);
    add(pair.cube + Eigen::Vector3i::Unit(pair.axis));
  }
  std::vector<SkinPoint> skin(cubes.size());
  parallel_for(cubes.size(), [&](std::size_t k) { skin[k] = nearest_(grid.centre(cubes[k])); });
  const auto skin_at = [&](std::size_t index) -> const SkinPoint& {
    return skin[static_cast<std::size_t>(place[index])];
  };

  std::vector<std::uint8_t> is_apart(neighbours.size());
  parallel_for(neighbours.size(), [&](std::size_t k) {
    is_apart[k] = apart_(skin_at(neighbours[k].index), skin_at(neighbours[k].next), grid.size) ? 1 : 0;
  });
  std::vector<std::uint8_t> cuts(grid.total(), 0);
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    if (is_apart[k] != 0) cuts[neighbours[k].index] |= bit(neighbours[k].axis);
  }
  keep_whole(
      grid, voxels, neighbours, [&](std::size_t index) { return main_joint(skin_at(index), weights_); }, cuts);
  return cuts;
}

}  // namespace bodyopt
