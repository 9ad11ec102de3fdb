#include "trainer/simulate/contact_points.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace bodyopt::trainer {
namespace {

void add_surface_nodes(const TetMesh& mesh, ContactPoints& points) {
  const Triangles surface = surface_of(mesh.tets);
  const Eigen::Index triangles = points.triangles.rows();
  points.triangles.conservativeResize(triangles + surface.rows(), 3);
  points.triangles.bottomRows(surface.rows()) = surface.array() + static_cast<std::uint32_t>(points.skin_count);
  points.rest.conservativeResize(points.skin_count + mesh.nodes.rows(), 3);
  points.rest.bottomRows(mesh.nodes.rows()) = mesh.nodes;
  points.embedded.resize(static_cast<std::size_t>(points.rest.rows()));
  for (int t = 0; t < mesh.tets.rows(); ++t) {
    for (int a = 0; a < 4; ++a) {
      points.embedded[static_cast<std::size_t>(points.skin_count + mesh.tets(t, a))] = {t, Eigen::Vector4d::Unit(a)};
    }
  }
}

// Sets edge and area; returns in how many triangles each point is.
Eigen::VectorXd measure_triangles(ContactPoints& points) {
  points.edge = points.area = Eigen::VectorXd::Zero(points.rest.rows());
  Eigen::VectorXd count = points.edge;
  for (const auto triangle : points.triangles.rowwise()) {
    const Eigen::RowVector3d a = points.rest.row(triangle[0]), b = points.rest.row(triangle[1]),
                             c = points.rest.row(triangle[2]);
    const double area = (b - a).cross(c - a).norm() / 2, around = (b - a).norm() + (c - b).norm() + (a - c).norm();
    for (const std::uint32_t v : triangle) {
      points.area[v] += area / 3;
      points.edge[v] += around / 3;
      count[v] += 1;
    }
  }
  points.edge = points.edge.cwiseQuotient(count.cwiseMax(1));
  return count;
}

// The node that a point is, or -1.
int node_of(const EmbeddedPoint& point, const Tets& tets) {
  constexpr double kRounding = 1e-9;
  int corner = 0;
  return point.weights.maxCoeff(&corner) > 1 - kRounding ? tets(point.tet, corner) : -1;
}

double mean_edge(const TetMesh& mesh, int tet) {
  double sum = 0;
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < a; ++b) sum += (mesh.nodes.row(mesh.tets(tet, a)) - mesh.nodes.row(mesh.tets(tet, b))).norm();
  }
  return sum / 6;
}

}  // namespace

ContactPoints contact_points(const Positions& skin, const Triangles& triangles, const Cage& cage) {
  ContactPoints points;
  points.skin_count = skin.rows();
  points.rest = skin;
  points.triangles = triangles;
  points.embedded = cage.skin;
  if (!cage.is_lattice) add_surface_nodes(cage.mesh, points);
  const Eigen::VectorXd count = measure_triangles(points);
  points.same_part = points.edge;
  std::vector<char> is_vertex(static_cast<std::size_t>(cage.mesh.nodes.rows()), 0);
  for (int p = 0; p < count.size(); ++p) {
    const EmbeddedPoint& point = points.embedded[static_cast<std::size_t>(p)];
    const Eigen::Vector4d inside = point.weights.cwiseMax(0);
    points.held.push_back({point.tet, inside / inside.sum()});
    if (!(count[p] > 0)) continue;
    const int node = node_of(point, cage.mesh.tets);
    if (p < points.skin_count) {
      points.same_part[p] = std::max(points.edge[p], mean_edge(cage.mesh, point.tet));
      if (node >= 0) is_vertex[static_cast<std::size_t>(node)] = 1;
    } else if (is_vertex[static_cast<std::size_t>(node)]) {
      continue;
    }
    points.touching.push_back(p);
  }
  return points;
}

}  // namespace bodyopt::trainer
