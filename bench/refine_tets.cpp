#include "bench/refine_tets.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

namespace bodyopt::bench {
namespace {

using Edge = std::pair<int, int>;
using Triangle = std::array<int, 3>;

// Corners of the triangle across from each corner, wound outwards.
constexpr int kAcross[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

Edge edge_of(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

// Triangles of one tet alone, by their sorted corners.
std::map<Triangle, Triangle> boundary(const Tets& tets) {
  std::map<Triangle, Triangle> triangles;
  for (Eigen::Index t = 0; t < tets.rows(); ++t) {
    for (const auto& across : kAcross) {
      const Triangle wound = {tets(t, across[0]), tets(t, across[1]), tets(t, across[2])};
      Triangle sorted = wound;
      std::sort(sorted.begin(), sorted.end());
      if (!triangles.emplace(sorted, wound).second) triangles.erase(sorted);
    }
  }
  return triangles;
}

// The number of each edge's middle: those of the surface follow its nodes, the others those inside.
std::map<Edge, int> number_middles(const TetMesh& mesh, Eigen::Index surface, Eigen::Index& on_surface) {
  std::set<Edge> outer, inner;
  for (const auto& [sorted, wound] : boundary(mesh.tets)) {
    for (std::size_t k = 0; k < 3; ++k) outer.insert(edge_of(wound[k], wound[(k + 1) % 3]));
  }
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    for (int a = 0; a < 4; ++a) {
      for (int b = a + 1; b < 4; ++b) {
        const Edge edge = edge_of(mesh.tets(t, a), mesh.tets(t, b));
        if (!outer.contains(edge)) inner.insert(edge);
      }
    }
  }
  std::map<Edge, int> middles;
  on_surface = surface;
  for (const Edge& edge : outer) middles[edge] = static_cast<int>(on_surface++);
  auto next = static_cast<int>(mesh.nodes.rows() + on_surface - surface);
  for (const Edge& edge : inner) middles[edge] = next++;
  return middles;
}

// Four at the corners; the octahedron between them is cut along the diagonal from 02 to 13.
constexpr int kParts[8][4][2] = {{{0, 0}, {0, 1}, {0, 2}, {0, 3}}, {{0, 1}, {1, 1}, {1, 2}, {1, 3}},
                                 {{0, 2}, {1, 2}, {2, 2}, {2, 3}}, {{0, 3}, {1, 3}, {2, 3}, {3, 3}},
                                 {{0, 1}, {0, 2}, {0, 3}, {1, 3}}, {{0, 1}, {0, 2}, {1, 2}, {1, 3}},
                                 {{0, 2}, {0, 3}, {1, 3}, {2, 3}}, {{0, 2}, {1, 2}, {1, 3}, {2, 3}}};

}  // namespace

FilledSkin refine_tets(const TetMesh& mesh, Eigen::Index surface) {
  Eigen::Index on_surface = 0;
  const std::map<Edge, int> middles = number_middles(mesh, surface, on_surface);
  const Eigen::Index added = on_surface - surface;
  const auto node_of = [&](int n) { return n < surface ? n : n + static_cast<int>(added); };
  FilledSkin result;
  TetMesh& fine = result.mesh;
  fine.nodes.resize(mesh.nodes.rows() + static_cast<Eigen::Index>(middles.size()), 3);
  for (int n = 0; n < mesh.nodes.rows(); ++n) fine.nodes.row(node_of(n)) = mesh.nodes.row(n);
  for (const auto& [edge, middle] : middles) {
    fine.nodes.row(middle) = (mesh.nodes.row(edge.first) + mesh.nodes.row(edge.second)) / 2;
  }
  fine.tets.resize(8 * mesh.tets.rows(), 4);
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    for (int part = 0; part < 8; ++part) {
      for (int k = 0; k < 4; ++k) {
        const int a = mesh.tets(t, kParts[part][k][0]), b = mesh.tets(t, kParts[part][k][1]);
        fine.tets(8 * t + part, k) = a == b ? node_of(a) : middles.at(edge_of(a, b));
      }
    }
  }
  orient(fine);
  const std::map<Triangle, Triangle> triangles = boundary(fine.tets);
  result.skin.vertices = fine.nodes.topRows(on_surface);
  result.skin.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  Eigen::Index row = 0;
  for (const auto& [sorted, wound] : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      result.skin.triangles(row, static_cast<Eigen::Index>(k)) = static_cast<std::uint32_t>(wound[k]);
    }
    ++row;
  }
  return result;
}

}  // namespace bodyopt::bench
