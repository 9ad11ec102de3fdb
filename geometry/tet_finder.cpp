#include "geometry/tet_finder.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <map>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

using Face = std::array<std::uint32_t, 3>;

Face sorted(Face corners) {
  std::sort(corners.begin(), corners.end());
  return corners;
}

std::map<Face, int> tets_of_faces(const Tets& tets) {
  std::map<Face, int> result;
  for (int t = 0; t < tets.rows(); ++t) {
    for (int left_out = 0; left_out < 4; ++left_out) {
      Face corners{};
      for (int k = 0; k < 3; ++k) {
        corners[static_cast<std::size_t>(k)] = static_cast<std::uint32_t>(tets(t, (left_out + 1 + k) % 4));
      }
      result[sorted(corners)] = t;
    }
  }
  return result;
}

}  // namespace

TetFinder::TetFinder(const TetMesh& mesh, const Positions& vertices, const Triangles& triangles)
    : nearest_(vertices, triangles), tree_(boxes_of(mesh.nodes, mesh.tets)) {
  for (int t = 0; t < mesh.tets.rows(); ++t) {
    tets_.push_back({mesh.nodes.row(mesh.tets(t, 0)), tet_edges(mesh, t).inverse()});
  }
  const std::map<Face, int> tet_of_face = tets_of_faces(mesh.tets);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const auto found = tet_of_face.find(sorted({triangles(t, 0), triangles(t, 1), triangles(t, 2)}));
    if (found == tet_of_face.end()) {
      throw Error(ErrorKind::mismatch,
                  "triangle " + std::to_string(t) + " of a coarser skin is no face of a tetrahedron");
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

}  // namespace bodyopt
