#include "trainer/tets/cage.h"

#include <algorithm>

#include "runtime/basis/error.h"
#include "trainer/tets/lattice_cage.h"
#include "trainer/tets/skin_cage.h"

namespace bodyopt {
namespace {

constexpr double kLeastQuality = 0.05;
constexpr double kFarthest = -1;   // barycentric: as far outside as the tet is high
constexpr double kMostFar = 0.01;  // of all vertices

// What is wrong with a filled skin; empty: nothing.
std::string defect_of(const Cage& cage) {
  if (cage.mesh.worst_quality < kLeastQuality) {
    return "filled more coarsely, its worst tetrahedron has a quality of " + std::to_string(cage.mesh.worst_quality);
  }
  const auto too_far = std::count_if(cage.skin.begin(), cage.skin.end(),
                                     [](const EmbeddedPoint& point) { return point.weights.minCoeff() < kFarthest; });
  if (static_cast<double>(too_far) <= kMostFar * static_cast<double>(cage.skin.size())) return "";
  return std::to_string(too_far) + " vertices lie too far outside a coarser skin";
}

}  // namespace

Cage make_cage(const Positions& vertices, const Triangles& triangles, Eigen::Index max_nodes) {
  std::string defect;
  try {
    Cage cage = skin_cage(vertices, triangles, max_nodes);
    defect = defect_of(cage);
    if (defect.empty()) return cage;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::mismatch) throw;
    defect = error.what();
  }
  Cage cage = lattice_cage(vertices, triangles, max_nodes);
  cage.why_lattice = defect;
  return cage;
}

}  // namespace bodyopt
