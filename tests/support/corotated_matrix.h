// The corotated operator of the jiggle as a dense matrix, from its definition, and tables to try it on.
#pragma once

#include <map>

#include "tests/simulate/tet_block.h"
#include "tests/support/random_jiggle.h"

namespace bodyopt::testing {

// Lame's parameters and held values of the order of 1: every node is joined to itself and some others, symmetrically.
inline JiggleTable random_corotated(Random& random, const TetTable& tets) {
  JiggleTable jiggle;
  for (std::uint32_t t = 0; t < tets.tet_count(); ++t) {
    jiggle.elasticity.push_back({static_cast<float>(random.uniform(0, 4)), static_cast<float>(random.uniform(0.2, 1))});
  }
  const std::uint32_t nodes = tets.node_count();
  std::vector<std::map<std::uint32_t, float>> rows(nodes);
  for (std::uint32_t n = 0; n < nodes; ++n) {
    const std::uint32_t other = random.below(nodes);
    rows[n][n] = static_cast<float>(random.uniform(1, 2));
    if (other != n) rows[n][other] = rows[other][n] = static_cast<float>(random.uniform(-0.1, 0.1));
  }
  jiggle.held_begin = {0};
  for (const auto& row : rows) {
    for (const auto& [column, value] : row) {
      jiggle.held_columns.push_back(column);
      jiggle.held_values.push_back(value);
    }
    jiggle.held_begin.push_back(static_cast<std::uint32_t>(jiggle.held_columns.size()));
  }
  return jiggle;
}

// A block of cubes with edges of 1.
inline TetTable block_tets(int nx, int ny, int nz) {
  const TetMesh mesh = tet_block(nx, ny, nz, 1);
  TetTable table;
  for (Eigen::Index n = 0; n < mesh.nodes.rows(); ++n) append_point(table.nodes, mesh.nodes.row(n).transpose());
  for (Eigen::Index k = 0; k < mesh.tets.size(); ++k) {
    table.tets.push_back(static_cast<std::uint32_t>(mesh.tets(k / 4, k % 4)));
  }
  complete_tets(table);
  return table;
}

// R^T (sum over tets of R_e K_e R_e^T + held) R, 3N x 3N: K_e has the blocks
// volume (lambda dN_a dN_b^T + mu dN_b dN_a^T + mu (dN_a . dN_b) I).
inline Eigen::MatrixXd corotated_matrix(const TetTable& tets, const JiggleTable& jiggle,
                                        std::span<const float> rotations, std::span<const float> tet_rotations) {
  const auto nodes = static_cast<Eigen::Index>(tets.node_count());
  Eigen::MatrixXd world = Eigen::MatrixXd::Zero(3 * nodes, 3 * nodes), turn = world;
  for (std::size_t t = 0; t < tets.shapes.size(); ++t) {
    const std::uint32_t* corners = tets.tets.data() + 4 * t;
    const Eigen::Matrix3d edges = tet_edges(tets.nodes, corners), r = matrix_of(tet_rotations, t);
    Eigen::Matrix<double, 4, 3> gradients;
    gradients.bottomRows<3>() = edges.inverse();
    gradients.row(0) = -gradients.bottomRows<3>().colwise().sum();
    const double lambda = jiggle.elasticity[t].lambda, mu = jiggle.elasticity[t].mu;
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        const Eigen::Vector3d na = gradients.row(a), nb = gradients.row(b);
        const Eigen::Matrix3d k =
            lambda * na * nb.transpose() + mu * nb * na.transpose() + mu * na.dot(nb) * Eigen::Matrix3d::Identity();
        world.block<3, 3>(3 * corners[a], 3 * corners[b]) += edges.determinant() / 6 * r * k * r.transpose();
      }
    }
  }
  for (Eigen::Index n = 0; n < nodes; ++n) {
    const auto row = static_cast<std::size_t>(n);
    turn.block<3, 3>(3 * n, 3 * n) = matrix_of(rotations, row);
    for (std::uint32_t k = jiggle.held_begin[row]; k < jiggle.held_begin[row + 1]; ++k) {
      world.block<3, 3>(3 * n, 3 * jiggle.held_columns[k]).diagonal().array() += jiggle.held_values[k];
    }
  }
  return turn.transpose() * world * turn;
}

inline Eigen::VectorXd doubles(std::span<const float> values) {
  return Eigen::Map<const Eigen::VectorXf>(values.data(), static_cast<Eigen::Index>(values.size())).cast<double>();
}

}  // namespace bodyopt::testing
