// A block of tets for tests.
#pragma once

#include <utility>

#include "geometry/tet_mesh.h"

namespace bodyopt {

// A block of cubes, five tets each, mirrored so that faces match.
inline TetMesh tet_block(int nx, int ny, int nz, double size) {
  TetMesh mesh;
  const auto node = [&](int x, int y, int z) { return (x * (ny + 1) + y) * (nz + 1) + z; };
  mesh.nodes.resize((nx + 1) * (ny + 1) * (nz + 1), 3);
  for (int x = 0; x <= nx; ++x) {
    for (int y = 0; y <= ny; ++y) {
      for (int z = 0; z <= nz; ++z) mesh.nodes.row(node(x, y, z)) << x * size, y * size, z * size;
    }
  }
  const int corners[5][4] = {{0, 3, 5, 6}, {1, 3, 0, 5}, {2, 0, 3, 6}, {4, 5, 0, 6}, {7, 3, 6, 5}};
  mesh.tets.resize(5 * nx * ny * nz, 4);
  int t = 0;
  for (int x = 0; x < nx; ++x) {
    for (int y = 0; y < ny; ++y) {
      for (int z = 0; z < nz; ++z) {
        const int mirror = (x + y + z) % 2;
        for (const auto& tet : corners) {
          for (int k = 0; k < 4; ++k) {
            const int c = mirror ? tet[k] ^ 1 : tet[k];
            mesh.tets(t, k) = node(x + (c >> 2 & 1), y + (c >> 1 & 1), z + (c & 1));
          }
          if (tet_edges(mesh, t).determinant() < 0) std::swap(mesh.tets(t, 2), mesh.tets(t, 3));
          ++t;
        }
      }
    }
  }
  return mesh;
}

}  // namespace bodyopt
