#include "trainer/tets/cage.h"

#include <algorithm>
#include <numeric>

#include "geometry/closed_skin.h"
#include "runtime/core/error.h"
#include "trainer/tets/lattice_cage.h"
#include "trainer/tets/skin_cage.h"

namespace bodyopt {
namespace {

// Barycentric weights of vertices far outside their tet: by its height, and by so much that one would be a spike.
constexpr double kFar = -1, kTooFar = -4;
constexpr double kMostFar = 0.01;  // of all vertices

// Pieces of skin that share no vertex.
int pieces(Eigen::Index vertices, const Triangles& triangles) {
  std::vector<std::uint32_t> root(static_cast<std::size_t>(vertices));
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  auto count = static_cast<int>(vertices);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 1; k < 3; ++k) {
      const std::uint32_t a = find(triangles(t, 0)), b = find(triangles(t, k));
      if (a == b) continue;
      root[std::max(a, b)] = std::min(a, b);
      --count;
    }
  }
  return count;
}

void require_near(const Cage& cage) {
  std::size_t far = 0, too_far = 0;
  for (const EmbeddedPoint& point : cage.skin) {
    far += point.weights.minCoeff() < kFar ? 1 : 0;
    too_far += point.weights.minCoeff() < kTooFar ? 1 : 0;
  }
  if (too_far == 0 && static_cast<double>(far) <= kMostFar * static_cast<double>(cage.skin.size())) return;
  throw Error(ErrorKind::mismatch, std::to_string(far) + " vertices lie far outside a coarser skin");
}

Cage filled_skin(const Positions& vertices, const Triangles& triangles, Eigen::Index max_nodes) {
  require_closed(vertices, triangles);
  // Only a lattice holds pieces together that no bone holds.
  if (const int count = pieces(vertices.rows(), triangles); count > 1) {
    throw Error(ErrorKind::mismatch, "the skin is in " + std::to_string(count) + " pieces");
  }
  Cage cage = skin_cage(vertices, triangles, max_nodes);
  require_near(cage);
  return cage;
}

}  // namespace

Cage make_cage(const Positions& vertices, const Triangles& triangles, Eigen::Index max_nodes) {
  std::string reason;
  try {
    return filled_skin(vertices, triangles, max_nodes);
  } catch (const Error& error) {
    reason = error.what();
  }
  Cage cage = lattice_cage(vertices, triangles, max_nodes);
  cage.why_lattice = reason;
  return cage;
}

}  // namespace bodyopt
