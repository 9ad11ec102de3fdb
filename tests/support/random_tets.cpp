#include "tests/support/random_tets.h"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <utility>

namespace bodyopt::testing {

Eigen::Vector3d point_of(std::span<const float> values, std::size_t k) {
  return Eigen::Map<const Eigen::Vector3f>(values.data() + 3 * k).cast<double>();
}

void append_point(std::vector<float>& values, const Eigen::Vector3d& point) {
  for (int i = 0; i < 3; ++i) values.push_back(static_cast<float>(point[i]));
}

Eigen::Matrix3d tet_edges(std::span<const float> nodes, const std::uint32_t* corners) {
  Eigen::Matrix3d edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = point_of(nodes, corners[k + 1]) - point_of(nodes, corners[0]);
  return edges;
}

void complete_tets(TetTable& table) {
  std::vector<std::vector<std::uint32_t>> around(table.node_count());
  for (std::uint32_t k = 0; k < table.tets.size(); ++k) around[table.tets[k]].push_back(k);
  for (std::size_t t = 0; t < table.tets.size() / 4; ++t) {
    const Eigen::Matrix3d edges = tet_edges(table.nodes, table.tets.data() + 4 * t);
    const Eigen::Matrix3d inverse = edges.inverse();
    TetShape shape{};
    for (int i = 0; i < 9; ++i) shape.inverse_edges[i] = static_cast<float>(inverse(i / 3, i % 3));
    shape.volume = static_cast<float>(edges.determinant() / 6);
    table.shapes.push_back(shape);
  }
  table.corner_begin = {0};
  for (const auto& corners : around) {
    table.corners.insert(table.corners.end(), corners.begin(), corners.end());
    table.corner_begin.push_back(static_cast<std::uint32_t>(table.corners.size()));
  }
}

TetTable random_tets(Random& random, std::uint32_t nodes) {
  TetTable table;
  table.nodes = random.floats(std::size_t{3} * nodes, -1, 1);
  while (nodes > 3 && table.tets.size() < std::size_t{4} * nodes) {
    std::array<std::uint32_t, 4> tet;
    for (std::uint32_t& corner : tet) corner = random.below(nodes);
    const double volume = tet_edges(table.nodes, tet.data()).determinant() / 6;
    if (std::abs(volume) < 0.02) continue;
    if (volume < 0) std::swap(tet[2], tet[3]);
    table.tets.insert(table.tets.end(), tet.begin(), tet.end());
  }
  complete_tets(table);
  return table;
}

std::vector<TetPoint> random_tet_points(Random& random, std::uint32_t tets, std::uint32_t vertices) {
  std::vector<TetPoint> points;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    std::array<double, 4> w;
    for (std::size_t k = 1; k < 4; ++k) w[k] = random.uniform(-0.1, 0.5);
    w[0] = 1 - w[1] - w[2] - w[3];
    const double amount = v % 3 == 0 ? 0 : random.uniform(0, 1);
    points.push_back({random.below(tets), static_cast<float>(w[0]), static_cast<float>(w[1]), static_cast<float>(w[2]),
                      static_cast<float>(w[3]), static_cast<float>(amount)});
  }
  return points;
}

std::vector<SurfacePoint> random_surface_points(Random& random, std::uint32_t vertices, std::uint32_t nodes) {
  std::vector<SurfacePoint> points;
  for (std::uint32_t n = 0; n < nodes; ++n) {
    const std::vector<double> w = random.partition(3);
    points.push_back({random.below(vertices), random.below(vertices), random.below(vertices), static_cast<float>(w[0]),
                      static_cast<float>(w[1]), static_cast<float>(w[2])});
  }
  return points;
}

}  // namespace bodyopt::testing
