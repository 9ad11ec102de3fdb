// The peer of localised components: one low-rank factorisation of everything.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace bodyopt::bench {

using RowMajorMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct Svd {
  Eigen::MatrixXf u;         // N x k
  Eigen::VectorXf singular;  // k, falling
  Eigen::MatrixXf v;         // M x k
};

// The leading k singular vectors of a matrix (N x M), nearly: Halko, Martinsson and Tropp 2011, algorithm 5.1 on the
// range that algorithm 4.4 finds with one power iteration and ten vectors more than asked for. Single precision;
// Eigen's products on as many threads as it is set to.
Svd randomised_svd(const RowMajorMatrix& matrix, Eigen::Index rank, std::uint32_t seed);

}  // namespace bodyopt::bench
