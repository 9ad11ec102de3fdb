#include "trainer/tets/second_order.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>

namespace bodyopt::trainer {
namespace {

constexpr int kEighths = 8;
// Edges of the octahedron between the corners' tets, around the line from the middle of edge 01 to that of edge 23.
using EdgeCorners = std::pair<int, int>;
constexpr EdgeCorners kAxis[2] = {{0, 1}, {2, 3}}, kAround[4] = {{0, 2}, {0, 3}, {1, 3}, {1, 2}};

// Corners of an eighth in barycentric weights of the whole, as columns.
Eigen::Matrix4d eighth_corners(int eighth) {
  Eigen::Matrix4d corners;
  const auto middle = [](EdgeCorners edge) -> Eigen::Vector4d {
    return (Eigen::Vector4d::Unit(edge.first) + Eigen::Vector4d::Unit(edge.second)) / 2;
  };
  for (int k = 0; k < 4; ++k) {
    if (eighth < 4) {
      corners.col(k) = middle({eighth, k});
    } else {
      corners.col(k) = k < 2 ? middle(kAxis[k]) : middle(kAround[(eighth + k) % 4]);
    }
  }
  return corners;
}

const std::array<Eigen::Matrix4d, kEighths>& into_eighths() {
  static const std::array<Eigen::Matrix4d, kEighths> inverses = [] {
    std::array<Eigen::Matrix4d, kEighths> result;
    for (int e = 0; e < kEighths; ++e) result[static_cast<std::size_t>(e)] = eighth_corners(e).inverse();
    return result;
  }();
  return inverses;
}

// The place of a point in the eighths of its tet.
EmbeddedPoint in_eighth(const EmbeddedPoint& point) {
  EmbeddedPoint best{0, Eigen::Vector4d::Constant(-std::numeric_limits<double>::infinity())};
  for (int e = 0; e < kEighths; ++e) {
    const Eigen::Vector4d weights = into_eighths()[static_cast<std::size_t>(e)] * point.weights;
    if (weights.minCoeff() > best.weights.minCoeff()) best = {kEighths * point.tet + e, weights};
  }
  return best;
}

}  // namespace

TetMesh second_order(const TetMesh& mesh) {
  const int corners = static_cast<int>(mesh.nodes.rows());
  std::map<EdgeCorners, int> middle;  // by corners, ascending: first on the surface, then inside
  int skin = 0, count = 0;
  const auto number = [&](int a, int b) {
    if (middle.try_emplace(std::minmax(a, b), count).second) ++count;
  };
  const Triangles surface = surface_of(mesh.tets);
  if (surface.size() > 0) skin = surface.maxCoeff() + 1;
  for_each_edge(surface, number);
  const int on_surface = count;
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    for (int a = 0; a < 4; ++a) {
      for (int b = a + 1; b < 4; ++b) number(mesh.tets(t, a), mesh.tets(t, b));
    }
  }
  const auto corner = [&](int n) { return n < skin ? n : n + on_surface; };
  const auto at = [&](int m) { return m < on_surface ? skin + m : corners + m; };
  TetMesh result;
  result.nodes.resize(corners + count, 3);
  for (int n = 0; n < corners; ++n) result.nodes.row(corner(n)) = mesh.nodes.row(n);
  for (const auto& [edge, m] : middle) {
    result.nodes.row(at(m)) = (mesh.nodes.row(edge.first) + mesh.nodes.row(edge.second)) / 2;
  }
  result.tets.resize(kEighths * mesh.tets.rows(), 4);
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    const auto node = [&](int a, int b) {
      const int n = mesh.tets(t, a), m = mesh.tets(t, b);
      return a == b ? corner(n) : at(middle.at(std::minmax(n, m)));
    };
    for (int e = 0; e < kEighths; ++e) {
      for (int k = 0; k < 4; ++k) {
        const EdgeCorners around = kAround[(e + k) % 4];
        result.tets(kEighths * t + e, k) = e < 4   ? node(e, k)
                                           : k < 2 ? node(kAxis[k].first, kAxis[k].second)
                                                   : node(around.first, around.second);
      }
    }
  }
  orient(result);
  result.is_second_order = true;
  return result;
}

Cage second_order(Cage cage) {
  cage.mesh = second_order(cage.mesh);
  for (EmbeddedPoint& point : cage.skin) point = in_eighth(point);
  for (CageSample& sample : cage.samples) sample.point = in_eighth(sample.point);
  return cage;
}

Eigen::SparseMatrix<double> from_corners(const TetMesh& second_order) {
  const Eigen::Index count = second_order.nodes.rows();
  std::vector<EdgeCorners> ends(static_cast<std::size_t>(count));  // of the edge that a node is the middle of
  std::vector<int> corner(static_cast<std::size_t>(count), -1);    // 0 where it is one, then its number
  for (Eigen::Index t = 0; t < second_order.tets.rows(); t += kEighths) {
    for (int a = 0; a < 4; ++a) {
      const int own = second_order.tets(t + a, a);
      corner[static_cast<std::size_t>(own)] = 0;
      for (int b = 0; b < 4; ++b) {
        ends[static_cast<std::size_t>(second_order.tets(t + a, b))] = {own, second_order.tets(t + b, b)};
      }
    }
  }
  int corners = 0;
  for (int& number : corner) number = number < 0 ? number : corners++;
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index n = 0; n < count; ++n) {
    const auto [a, b] = ends[static_cast<std::size_t>(n)];
    for (const int end : {a, b}) entries.emplace_back(n, corner[static_cast<std::size_t>(end)], 0.5);
  }
  return sparse_matrix(count, corners, entries);  // of a corner, both ends are itself
}

}  // namespace bodyopt::trainer
