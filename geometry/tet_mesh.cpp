#include "geometry/tet_mesh.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace bodyopt {
namespace {

// Corners of the face opposite to each corner, outwards for a tet of positive volume.
constexpr int kFace[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

}  // namespace

void orient(TetMesh& mesh) {
  mesh.worst_quality = 1;
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    if (tet_edges(mesh, t).determinant() < 0) std::swap(mesh.tets(t, 2), mesh.tets(t, 3));
    mesh.worst_quality = std::min(mesh.worst_quality, mean_ratio(mesh, t));
  }
}

double mean_ratio(const TetMesh& mesh, Eigen::Index tet) {
  Eigen::Vector3d corner[4];
  for (int k = 0; k < 4; ++k) corner[k] = mesh.nodes.row(mesh.tets(tet, k));
  const double volume = (corner[1] - corner[0]).cross(corner[2] - corner[0]).dot(corner[3] - corner[0]) / 6;
  double squares = 0;
  for (int a = 0; a < 4; ++a) {
    for (int b = a + 1; b < 4; ++b) squares += (corner[a] - corner[b]).squaredNorm();
  }
  return squares > 0 ? 12 * std::cbrt(9 * volume * volume) / squares : 0;
}

Eigen::Matrix3d tet_edges(const TetMesh& mesh, Eigen::Index tet) {
  Eigen::Matrix3d edges;
  for (int a = 0; a < 3; ++a) edges.col(a) = mesh.nodes.row(mesh.tets(tet, a + 1)) - mesh.nodes.row(mesh.tets(tet, 0));
  return edges;
}

double volume(const TetMesh& mesh) {
  double sum = 0;
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) sum += tet_edges(mesh, t).determinant() / 6;
  return sum;
}

std::vector<Eigen::Vector4d> tet_lattice(int rows) {
  std::vector<Eigen::Vector4d> points;
  for (int i = 0; i <= rows; ++i) {
    for (int j = 0; i + j <= rows; ++j) {
      for (int k = 0; i + j + k <= rows; ++k) {
        const Eigen::Vector4d corner(i, j, k, rows - i - j - k);
        points.push_back((corner.array() + 0.25) / (rows + 1.0));
      }
    }
  }
  return points;
}

Triangles surface_of(const Tets& tets) {
  struct Face {
    std::array<int, 3> corners;
    int uses;
  };
  std::map<std::array<int, 3>, Face> faces;
  for (Eigen::Index t = 0; t < tets.rows(); ++t) {
    for (const auto& face : kFace) {
      const std::array<int, 3> corners{tets(t, face[0]), tets(t, face[1]), tets(t, face[2])};
      std::array<int, 3> key = corners;
      std::sort(key.begin(), key.end());
      ++faces.try_emplace(key, Face{corners, 0}).first->second.uses;
    }
  }
  std::vector<std::array<int, 3>> open;
  for (const auto& [key, face] : faces) {
    if (face.uses == 1) open.push_back(face.corners);
  }
  Triangles triangles(static_cast<Eigen::Index>(open.size()), 3);
  for (std::size_t t = 0; t < open.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      triangles(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(k)) = static_cast<std::uint32_t>(open[t][k]);
    }
  }
  return triangles;
}

}  // namespace bodyopt
