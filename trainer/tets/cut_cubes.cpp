#include "trainer/tets/cut_cubes.h"

#include "base/disjoint_sets.h"
#include "base/parallel.h"
#include "trainer/tets/apart_skin.h"

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

std::uint8_t bit(int axis) { return static_cast<std::uint8_t>(1 << axis); }

// Takes back the cuts between what hangs together by nothing else.
void keep_whole(const VoxelGrid& grid, const std::vector<Voxel>& voxels, std::vector<std::uint8_t>& cuts) {
  DisjointSets whole(grid.total());
  for_neighbours(grid, voxels, [&](const Eigen::Vector3i&, int axis, std::size_t index, std::size_t next) {
    if ((cuts[index] & bit(axis)) == 0) whole.join(index, next);
  });
  for_neighbours(grid, voxels, [&](const Eigen::Vector3i&, int axis, std::size_t index, std::size_t next) {
    if (whole.lowest(index) != whole.lowest(next)) cuts[index] = static_cast<std::uint8_t>(cuts[index] & ~bit(axis));
  });
}

}  // namespace

std::vector<std::uint8_t> cut_cubes(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                                    const VoxelGrid& grid, const std::vector<Voxel>& voxels) {
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
  const NearestSkin nearest(vertices, triangles);
  std::vector<SkinPoint> skin(cubes.size());
  parallel_for(cubes.size(), [&](std::size_t k) { skin[k] = nearest(grid.centre(cubes[k])); });
  const auto skin_at = [&](std::size_t index) -> const SkinPoint& {
    return skin[static_cast<std::size_t>(place[index])];
  };

  const ApartSkin apart(vertices, triangles, weights, grid.size);
  std::vector<std::uint8_t> is_apart(neighbours.size());
  parallel_for(neighbours.size(), [&](std::size_t k) {
    is_apart[k] = apart(skin_at(neighbours[k].index), skin_at(neighbours[k].next)) ? 1 : 0;
  });
  std::vector<std::uint8_t> cuts(grid.total(), 0);
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    if (is_apart[k] != 0) cuts[neighbours[k].index] |= bit(neighbours[k].axis);
  }
  keep_whole(grid, voxels, cuts);
  return cuts;
}

}  // namespace bodyopt
