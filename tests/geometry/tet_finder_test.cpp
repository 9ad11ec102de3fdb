#include <gtest/gtest.h>

#include <array>
#include <map>
#include <random>
#include <set>

#include "geometry/tet_mesh.h"

namespace bodyopt {
namespace {

// A block of cubes, six tets each around a diagonal, and its surface.
struct Block {
  TetMesh mesh;
  Triangles surface;
};

Block block(int cells) {
  Block result;
  const int side = cells + 1;
  result.mesh.nodes.resize(side * side * side, 3);
  for (int n = 0; n < side * side * side; ++n) {
    result.mesh.nodes.row(n) << n % side, n / side % side, n / side / side;
  }
  const int steps[3] = {1, side, side * side};
  std::vector<std::array<int, 4>> tets;
  for (int n = 0; n < side * side * side; ++n) {
    if (n % side == cells || n / side % side == cells || n / side / side == cells) continue;
    std::array order = {0, 1, 2};
    do {
      tets.push_back({n, n + steps[order[0]], n + steps[order[0]] + steps[order[1]], n + 1 + side + side * side});
    } while (std::next_permutation(order.begin(), order.end()));
  }
  result.mesh.tets.resize(static_cast<Eigen::Index>(tets.size()), 4);
  std::map<std::set<int>, std::pair<int, std::array<int, 4>>> faces;  // how often, and the last tet
  for (std::size_t t = 0; t < tets.size(); ++t) {
    for (int k = 0; k < 4; ++k)
      result.mesh.tets(static_cast<Eigen::Index>(t), k) = tets[t][static_cast<std::size_t>(k)];
  }
  orient(result.mesh);
  for (std::size_t t = 0; t < tets.size(); ++t) {
    for (std::size_t left_out = 0; left_out < 4; ++left_out) {
      std::set<int> face(tets[t].begin(), tets[t].end());
      face.erase(tets[t][left_out]);
      auto& [count, tet] = faces[face];
      ++count;
      tet = tets[t];
    }
  }
  std::vector<std::array<int, 3>> outer;
  for (const auto& [face, of] : faces) {
    if (of.first > 1) continue;
    std::array<int, 3> corners{};
    std::copy(face.begin(), face.end(), corners.begin());
    const auto at = [&](int n) { return Eigen::Vector3d(result.mesh.nodes.row(n)); };
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const int n : of.second) middle += at(n) / 4;
    const Eigen::Vector3d normal = (at(corners[1]) - at(corners[0])).cross(at(corners[2]) - at(corners[0]));
    if (normal.dot(at(corners[0]) - middle) < 0) std::swap(corners[1], corners[2]);
    outer.push_back(corners);
  }
  result.surface.resize(static_cast<Eigen::Index>(outer.size()), 3);
  for (std::size_t t = 0; t < outer.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      result.surface(static_cast<Eigen::Index>(t), k) =
          static_cast<std::uint32_t>(outer[t][static_cast<std::size_t>(k)]);
    }
  }
  return result;
}

// What of all tets has the point deepest inside, by their weights alone.
double deepest(const TetMesh& mesh, const Eigen::Vector3d& point) {
  double most = -1e300;
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    const Eigen::Vector3d origin = mesh.nodes.row(mesh.tets(t, 0));
    Eigen::Vector4d weights;
    weights.tail<3>() = tet_edges(mesh, t).inverse() * (point - origin);
    weights[0] = 1 - weights.tail<3>().sum();
    most = std::max(most, weights.minCoeff());
  }
  return most;
}

Eigen::Vector3d position(const TetMesh& mesh, const EmbeddedPoint& point) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int k = 0; k < 4; ++k) sum += point.weights[k] * mesh.nodes.row(mesh.tets(point.tet, k)).transpose();
  return sum;
}

TEST(TetFinder, FindsTheTetThatAPointLiesDeepestIn) {
  const Block of = block(4);
  const TetFinder find(of.mesh, of.mesh.nodes, of.surface);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> inside(0.05, 3.95);
  for (int k = 0; k < 100; ++k) {
    const Eigen::Vector3d point(inside(random), inside(random), inside(random));
    const EmbeddedPoint found = find(point, Eigen::Vector3d::UnitY());
    EXPECT_NEAR(found.weights.minCoeff(), deepest(of.mesh, point), 1e-12);
    EXPECT_GE(found.weights.minCoeff(), 0);
    EXPECT_LT((position(of.mesh, found) - point).norm(), 1e-12);
  }
}

// In the tet behind the side that it is above, whatever is near beside.
TEST(TetFinder, APointOutsideHangsOnTheSideThatFacesAsItDoes) {
  const Block of = block(3);
  const TetFinder find(of.mesh, of.mesh.nodes, of.surface);
  const Eigen::Vector3d above(1.3, 3.2, 2.99), beside(1.3, 2.99, 3.2);
  for (const Eigen::Vector3d& point : {above, beside}) {
    const bool is_above = point.y() > 3;
    const EmbeddedPoint found = find(point, is_above ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ());
    EXPECT_LT(found.weights.minCoeff(), 0);
    EXPECT_LT((position(of.mesh, found) - point).norm(), 1e-12);
    int on_side = 0;
    for (int k = 0; k < 4; ++k) on_side += of.mesh.nodes(of.mesh.tets(found.tet, k), is_above ? 1 : 2) == 3 ? 1 : 0;
    EXPECT_EQ(on_side, 3);
  }
}

// On the face of two tets it stays in the one behind the side that it lies on.
TEST(TetFinder, APointOnTheSkinStaysBehindItsSide) {
  const Block of = block(2);
  const TetFinder find(of.mesh, of.mesh.nodes, of.surface);
  for (int n = 0; n < of.mesh.nodes.rows(); ++n) {
    const Eigen::Vector3d node = of.mesh.nodes.row(n);
    if (node.y() != 2 || node.x() != 1 || node.z() != 1) continue;
    const EmbeddedPoint found = find(node, Eigen::Vector3d::UnitY());
    int on_side = 0;
    for (int k = 0; k < 4; ++k) on_side += of.mesh.nodes(of.mesh.tets(found.tet, k), 1) == 2 ? 1 : 0;
    EXPECT_EQ(on_side, 3);
  }
}

}  // namespace
}  // namespace bodyopt
