#include "geometry/embedding.h"

#include <Eigen/LU>

namespace bodyopt {

namespace {

Eigen::RowVector3d blend(const Positions& nodes, const Tets& tets, const EmbeddedPoint& point) {
  Eigen::RowVector3d sum = point.weights[0] * nodes.row(tets(point.tet, 0));
  for (int a = 1; a < 4; ++a) sum += point.weights[a] * nodes.row(tets(point.tet, a));
  return sum;
}

}  // namespace

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
