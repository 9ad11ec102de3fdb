#include "trainer/tets/voxels.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace bodyopt::trainer {
namespace {

// Does a triangle touch a cube around the origin? Separating axes decide (Akenine-Möller 2001).
bool touches(const CornerPoints& triangle, double half_edge) {
  const auto separates = [&](const Eigen::Vector3d& axis) {
    const double a = axis.dot(triangle[0]), b = axis.dot(triangle[1]), c = axis.dot(triangle[2]);
    const double reach = half_edge * axis.cwiseAbs().sum();
    return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
  };
  const Eigen::Vector3d edges[3] = {triangle[1] - triangle[0], triangle[2] - triangle[1], triangle[0] - triangle[2]};
  for (int i = 0; i < 3; ++i) {
    if (separates(Eigen::Vector3d::Unit(i))) return false;
    for (const Eigen::Vector3d& edge : edges) {
      if (separates(Eigen::Vector3d::Unit(i).cross(edge))) return false;
    }
  }
  return !separates(edges[0].cross(edges[1]));
}

void mark_surface(const Positions& vertices, const Triangles& triangles, const VoxelGrid& grid,
                  std::vector<Voxel>& voxels) {
  for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
    voxels[grid.index(grid.cube_at(vertices.row(v)))] = Voxel::surface;
  }
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const CornerPoints triangle = corners_of(vertices, triangles, t);
    const Eigen::Vector3i low = grid.cube_at(triangle[0].cwiseMin(triangle[1]).cwiseMin(triangle[2]));
    const Eigen::Vector3i high = grid.cube_at(triangle[0].cwiseMax(triangle[1]).cwiseMax(triangle[2]));
    for_each_cube(low, high.array() + 1, [&](const Eigen::Vector3i& cube) {
      const Eigen::Vector3d centre = grid.centre(cube);
      if (touches({triangle[0] - centre, triangle[1] - centre, triangle[2] - centre}, grid.size / 2)) {
        voxels[grid.index(cube)] = Voxel::surface;
      }
    });
  }
}

// Calls cross(line cube, first cube beyond) for every line of cube centres along `axis` that runs through the triangle.
template <typename Cross>
void for_crossings(const CornerPoints& triangle, const VoxelGrid& grid, int axis, const Cross& cross) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  Eigen::Vector3d p[3];
  for (std::size_t k = 0; k < 3; ++k) p[k] = (triangle[k] - grid.origin) / grid.size - Eigen::Vector3d::Constant(0.5);
  const double area = (p[1][u] - p[0][u]) * (p[2][v] - p[0][v]) - (p[1][v] - p[0][v]) * (p[2][u] - p[0][u]);
  if (area == 0) return;
  const auto first = [](double a, double b, double c) { return static_cast<int>(std::ceil(std::min({a, b, c}))); };
  const auto last = [](double a, double b, double c) { return static_cast<int>(std::floor(std::max({a, b, c}))); };
  for (int i = first(p[0][u], p[1][u], p[2][u]); i <= last(p[0][u], p[1][u], p[2][u]); ++i) {
    for (int j = first(p[0][v], p[1][v], p[2][v]); j <= last(p[0][v], p[1][v], p[2][v]); ++j) {
      double weight[3];
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d &a = p[(k + 1) % 3], &b = p[(k + 2) % 3];
        weight[k] = ((a[u] - i) * (b[v] - j) - (a[v] - j) * (b[u] - i)) / area;
      }
      if (weight[0] < 0 || weight[1] < 0 || weight[2] < 0) continue;
      const double depth = weight[0] * p[0][axis] + weight[1] * p[1][axis] + weight[2] * p[2][axis];
      Eigen::Vector3i cube;
      cube[u] = i;
      cube[v] = j;
      cube[axis] = std::clamp(static_cast<int>(std::ceil(depth)), 0, grid.count[axis]);
      cross(cube, area > 0 ? -1 : 1);
    }
  }
}

// Adds to every cube the winding numbers seen along the rays to either side of one axis.
void add_windings(const Positions& vertices, const Triangles& triangles, const VoxelGrid& grid, int axis,
                  std::vector<std::int32_t>& windings) {
  std::vector<std::int32_t> entering(grid.total(), 0);  // signed crossings just before each cube
  Eigen::Vector3i plane = grid.count;
  plane[axis] = 1;
  const VoxelGrid lines{grid.origin, grid.size, plane};
  std::vector<std::int32_t> past_the_end(lines.total(), 0);
  const auto line_of = [&](Eigen::Vector3i cube) {
    cube[axis] = 0;
    return lines.index(cube);
  };
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for_crossings(corners_of(vertices, triangles, t), grid, axis, [&](const Eigen::Vector3i& cube, int sign) {
      auto& count = cube[axis] < grid.count[axis] ? entering[grid.index(cube)] : past_the_end[line_of(cube)];
      count = static_cast<std::int32_t>(count + sign);
    });
  }
  for_each_cube(Eigen::Vector3i::Zero(), plane, [&](const Eigen::Vector3i& cube) {
    Eigen::Vector3i along = cube;
    int all = past_the_end[lines.index(cube)], before = 0;
    for (along[axis] = 0; along[axis] < grid.count[axis]; ++along[axis]) all += entering[grid.index(along)];
    for (along[axis] = 0; along[axis] < grid.count[axis]; ++along[axis]) {
      before += entering[grid.index(along)];
      std::int32_t& sum = windings[grid.index(along)];
      sum = static_cast<std::int32_t>(sum + before + (before - all));
    }
  });
}

}  // namespace

std::vector<Voxel> voxelise(const Positions& vertices, const Triangles& triangles, const VoxelGrid& grid) {
  constexpr int kRays = 6;
  std::vector<std::int32_t> windings(grid.total(), 0);
  for (int axis = 0; axis < 3; ++axis) add_windings(vertices, triangles, grid, axis, windings);
  std::vector<Voxel> voxels(grid.total(), Voxel::outside);
  for (std::size_t k = 0; k < voxels.size(); ++k) {
    if (2 * std::abs(windings[k]) > kRays) voxels[k] = Voxel::inside;
  }
  mark_surface(vertices, triangles, grid, voxels);
  return voxels;
}

std::vector<int> label_pieces(const VoxelGrid& grid, const std::vector<Voxel>& voxels) {
  struct Piece {
    std::size_t size = 0;
    bool surface = false;
  };
  const std::size_t stride[3] = {1, static_cast<std::size_t>(grid.count[0]),
                                 static_cast<std::size_t>(grid.count[0]) * static_cast<std::size_t>(grid.count[1])};
  std::vector<int> label(voxels.size(), -1);
  std::vector<Piece> pieces;
  std::vector<std::size_t> open;
  for (std::size_t seed = 0; seed < voxels.size(); ++seed) {
    if (voxels[seed] == Voxel::outside || label[seed] >= 0) continue;
    const int piece = static_cast<int>(pieces.size());
    pieces.emplace_back();
    label[seed] = piece;
    open.push_back(seed);
    while (!open.empty()) {
      const std::size_t at = open.back();
      open.pop_back();
      ++pieces.back().size;
      pieces.back().surface = pieces.back().surface || voxels[at] == Voxel::surface;
      for (int axis = 0; axis < 3; ++axis) {
        const std::size_t along = at / stride[axis] % static_cast<std::size_t>(grid.count[axis]);
        for (const bool up : {false, true}) {
          if (up ? along + 1 == static_cast<std::size_t>(grid.count[axis]) : along == 0) continue;
          const std::size_t next = up ? at + stride[axis] : at - stride[axis];
          if (voxels[next] == Voxel::outside || label[next] >= 0) continue;
          label[next] = piece;
          open.push_back(next);
        }
      }
    }
  }
  std::vector<int> by_size(pieces.size());
  std::iota(by_size.begin(), by_size.end(), 0);
  std::erase_if(by_size, [&](int piece) { return !pieces[static_cast<std::size_t>(piece)].surface; });
  std::ranges::stable_sort(by_size, [&](int a, int b) {
    return pieces[static_cast<std::size_t>(a)].size > pieces[static_cast<std::size_t>(b)].size;
  });
  std::vector<int> rank(pieces.size(), -1);
  for (std::size_t k = 0; k < by_size.size(); ++k) rank[static_cast<std::size_t>(by_size[k])] = static_cast<int>(k);
  for (int& piece : label) piece = piece < 0 ? -1 : rank[static_cast<std::size_t>(piece)];
  return label;
}

}  // namespace bodyopt::trainer
