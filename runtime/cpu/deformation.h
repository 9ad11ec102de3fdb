// Deformation gradient of a tet: what the rotations of nodes and of tets are found from.
#pragma once

#include "runtime/basis/dynamics.h"

namespace bodyopt::cpu {

// F = D(X) D^-1, row-major. nodes: N x 3 of the frame.
inline void deformation_gradient(const TetTable& tets, std::size_t tet, const float* nodes, float (&f)[9]) {
  const std::uint32_t* corners = tets.tets.data() + 4 * tet;
  const float* inverse = tets.shapes[tet].inverse_edges;
  const float* origin = nodes + std::size_t{3} * corners[0];
  float edges[9];
  for (std::size_t j = 0; j < 3; ++j) {
    const float* corner = nodes + std::size_t{3} * corners[1 + j];
    for (std::size_t i = 0; i < 3; ++i) edges[3 * i + j] = corner[i] - origin[i];
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      f[3 * i + k] = edges[3 * i] * inverse[k] + edges[3 * i + 1] * inverse[3 + k] + edges[3 * i + 2] * inverse[6 + k];
    }
  }
}

}  // namespace bodyopt::cpu
