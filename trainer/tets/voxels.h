// A skin of any kind as a solid of small cubes.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/mesh.h"

namespace bodyopt::trainer {

// A regular grid of cubes; (0, 0, 0) starts at `origin`.
struct VoxelGrid {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // metres
  double size = 0;                                   // edge of a cube, metres
  Eigen::Vector3i count = Eigen::Vector3i::Zero();   // cubes along x, y, z

  std::size_t index(const Eigen::Vector3i& cube) const {
    return (static_cast<std::size_t>(cube[2]) * static_cast<std::size_t>(count[1]) +
            static_cast<std::size_t>(cube[1])) *
               static_cast<std::size_t>(count[0]) +
           static_cast<std::size_t>(cube[0]);
  }
  std::size_t total() const {
    return static_cast<std::size_t>(count[0]) * static_cast<std::size_t>(count[1]) * static_cast<std::size_t>(count[2]);
  }
  bool contains(const Eigen::Vector3i& cube) const {
    return (cube.array() >= 0).all() && (cube.array() < count.array()).all();
  }
  Eigen::Vector3i cube_at(const Eigen::Vector3d& point) const {
    return ((point - origin) / size).array().floor().cast<int>();
  }
  Eigen::Vector3d centre(const Eigen::Vector3i& cube) const {
    return origin + size * (cube.cast<double>().array() + 0.5).matrix();
  }
};

// Calls visit(cube) for all cubes from `low` on and below `end`, along x first.
void for_each_cube(const Eigen::Vector3i& low, const Eigen::Vector3i& end, const auto& visit) {
  Eigen::Vector3i cube;
  for (cube[2] = low[2]; cube[2] < end[2]; ++cube[2]) {
    for (cube[1] = low[1]; cube[1] < end[1]; ++cube[1]) {
      for (cube[0] = low[0]; cube[0] < end[0]; ++cube[0]) visit(cube);
    }
  }
}

enum class Voxel : std::uint8_t { outside, surface, inside };

// Every cube of the grid by index: `surface` where it touches a triangle or holds a vertex. A cube is `inside` if its
// winding number is above one half, or below minus that. Averaged over the six rays along the axes, it hardly suffers
// from holes and flipped or doubled faces. The grid must cover the skin.
std::vector<Voxel> voxelise(const Positions& vertices, const Triangles& triangles, const VoxelGrid& grid);

// A number for every cube: 0 for the largest piece (cubes joined through faces), 1 for the next and so on; -1 outside.
// Pieces without surface are taken for outside.
std::vector<int> label_pieces(const VoxelGrid& grid, const std::vector<Voxel>& voxels);

}  // namespace bodyopt::trainer
