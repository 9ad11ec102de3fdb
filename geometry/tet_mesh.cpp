#include "geometry/tet_mesh.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

// Corners of the face opposite to each corner, outwards for a tet of positive volume.
constexpr int kFace[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

using Face = std::array<std::uint32_t, 3>;

Face face_corners(const Tets& tets, Eigen::Index t, const int (&face)[3]) {
  const auto corner = [&](int k) { return static_cast<std::uint32_t>(tets(t, face[k])); };
  return {corner(0), corner(1), corner(2)};
}

Face sorted(Face corners) {
  std::ranges::sort(corners);
  return corners;
}

std::map<Face, int> tets_of_faces(const Tets& tets) {
  std::map<Face, int> result;
  for (int t = 0; t < tets.rows(); ++t) {
    for (const auto& face : kFace) result[sorted(face_corners(tets, t, face))] = t;
  }
  return result;
}

Eigen::RowVector3d blend(const Positions& nodes, const Tets& tets, const EmbeddedPoint& point) {
  Eigen::RowVector3d sum = point.weights[0] * nodes.row(tets(point.tet, 0));
  for (int a = 1; a < 4; ++a) sum += point.weights[a] * nodes.row(tets(point.tet, a));
  return sum;
}

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

Eigen::Matrix<double, 4, 3> corner_slopes(const Eigen::Matrix3d& edges) {
  Eigen::Matrix<double, 4, 3> slopes;
  slopes.bottomRows<3>() = edges.inverse();
  slopes.row(0) = -slopes.bottomRows<3>().colwise().sum();
  return slopes;
}

double volume(const TetMesh& mesh) {
  double sum = 0;
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) sum += tet_edges(mesh, t).determinant() / 6;
  return sum;
}

std::vector<Eigen::Vector4d> tet_lattice(int rows, double inset) {
  std::vector<Eigen::Vector4d> points;
  for (int i = 0; i <= rows; ++i) {
    for (int j = 0; i + j <= rows; ++j) {
      for (int k = 0; i + j + k <= rows; ++k) {
        const Eigen::Vector4d corner(i, j, k, rows - i - j - k);
        points.push_back((corner.array() + inset) / (rows + 4 * inset));
      }
    }
  }
  return points;
}

Triangles surface_of(const Tets& tets) {
  struct Use {
    Face corners;
    int count = 0;
  };
  std::map<Face, Use> faces;
  for (Eigen::Index t = 0; t < tets.rows(); ++t) {
    for (const auto& face : kFace) {
      const Face corners = face_corners(tets, t, face);
      ++faces.try_emplace(sorted(corners), Use{corners}).first->second.count;
    }
  }
  std::vector<Face> open;
  for (const auto& [key, use] : faces) {
    if (use.count == 1) open.push_back(use.corners);
  }
  return triangles_of(open);
}

TetFinder::TetFinder(const TetMesh& mesh, const Positions& vertices, const Triangles& triangles)
    : nearest_(vertices, triangles), tree_(boxes_of(mesh.nodes, mesh.tets)) {
  for (int t = 0; t < mesh.tets.rows(); ++t) {
    tets_.push_back({mesh.nodes.row(mesh.tets(t, 0)), tet_edges(mesh, t).inverse()});
  }
  const std::map<Face, int> tet_of_face = tets_of_faces(mesh.tets);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const auto found = tet_of_face.find(sorted({triangles(t, 0), triangles(t, 1), triangles(t, 2)}));
    if (found == tet_of_face.end()) {
      throw Error(ErrorKind::mismatch, "triangle ", t, " of a coarser skin is no face of a tetrahedron");
    }
    behind_.push_back(found->second);
  }
}

EmbeddedPoint TetFinder::operator()(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
  const SkinPoint facing = nearest_.facing(point, normal);
  const bool is_outside = facing.triangle >= 0 && (point - facing.position).dot(normal) > 0;
  const int behind =
      behind_[static_cast<std::size_t>(facing.triangle >= 0 ? facing.triangle : nearest_(point).triangle)];
  return is_outside ? EmbeddedPoint{behind, weights(behind, point)} : deepest(point, behind);
}

EmbeddedPoint TetFinder::operator()(const Eigen::Vector3d& point) const {
  return deepest(point, behind_[static_cast<std::size_t>(nearest_(point).triangle)]);
}

EmbeddedPoint TetFinder::deepest(const Eigen::Vector3d& point, int behind) const {
  EmbeddedPoint best{behind, weights(behind, point)};
  const auto consider = [&](int t) {
    const Eigen::Vector4d inside = weights(t, point);
    const double least = inside.minCoeff(), least_of_best = best.weights.minCoeff();
    const bool as_deep = least == least_of_best && t < best.tet && best.tet != behind;  // of others the first
    if (least >= 0 && (least > least_of_best || as_deep)) best = {t, inside};
    return 0.0;
  };
  tree_.search([&](const Eigen::AlignedBox3d& box) { return box.contains(point) ? 0.0 : 1.0; }, consider, 0);
  return best;
}

Eigen::Vector4d TetFinder::weights(int t, const Eigen::Vector3d& point) const {
  const Tet& tet = tets_[static_cast<std::size_t>(t)];
  Eigen::Vector4d result;
  result.tail<3>() = tet.inverse * (point - tet.origin);
  result[0] = 1 - result.tail<3>().sum();
  return result;
}

Positions embed(const std::vector<EmbeddedPoint>& points, const Tets& tets, const Positions& nodes) {
  Positions result(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t p = 0; p < points.size(); ++p) {
    result.row(static_cast<Eigen::Index>(p)) = blend(nodes, tets, points[p]);
  }
  return result;
}

Eigen::Vector4d weights_in(const TetMesh& mesh, Eigen::Index tet, const Eigen::RowVector3d& point) {
  Eigen::Vector4d weights;
  weights.tail<3>() = tet_edges(mesh, tet).inverse() * (point - mesh.nodes.row(mesh.tets(tet, 0))).transpose();
  weights[0] = 1 - weights.tail<3>().sum();
  return weights;
}

Eigen::Vector3d rest_position(const TetMesh& mesh, const EmbeddedPoint& point) {
  return blend(mesh.nodes, mesh.tets, point);
}

}  // namespace bodyopt
