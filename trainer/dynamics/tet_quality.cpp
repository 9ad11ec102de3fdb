#include "trainer/dynamics/tet_quality.h"

#include <Eigen/LU>
#include <algorithm>
#include <vector>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

// Flatter tets give no inverse in single precision that is worth its name.
constexpr double kFlat = 1e-4;

[[noreturn]] void refuse(const std::string& what, const std::string& cause) {
  throw Error(ErrorKind::mismatch, "the tetrahedra cannot carry finite elements: " + what + " (" + cause + ")");
}

std::string name_of(Eigen::Index tet) { return "tetrahedron " + std::to_string(tet); }

}  // namespace

TetQuality tet_quality(const TetMesh& mesh) {
  std::vector<double> quality;
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) quality.push_back(mean_ratio(mesh, t));
  if (quality.empty()) return {};
  std::sort(quality.begin(), quality.end());
  return {quality.front(), quality[quality.size() / 100], quality[quality.size() / 2]};
}

void require_sound(const TetMesh& mesh) {
  if (mesh.tets.rows() == 0) refuse("there are none", "an empty mesh");
  if (!mesh.nodes.allFinite()) refuse("a node is not a finite number", "a damaged file");
  std::vector<bool> used(static_cast<std::size_t>(mesh.nodes.rows()), false);
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    for (int a = 0; a < 4; ++a) {
      const int node = mesh.tets(t, a);
      if (node < 0 || node >= mesh.nodes.rows()) {
        refuse(name_of(t) + " names node " + std::to_string(node) + " of " + std::to_string(mesh.nodes.rows()),
               "a damaged file");
      }
      used[static_cast<std::size_t>(node)] = true;
    }
    if (mean_ratio(mesh, t) < kFlat) refuse(name_of(t) + " is flat: it has no volume", "nodes in one place or plane");
    if (tet_edges(mesh, t).determinant() < 0) refuse(name_of(t) + " is inverted", "corners in the wrong order");
  }
  const auto orphan = std::find(used.begin(), used.end(), false);
  if (orphan == used.end()) return;
  refuse("node " + std::to_string(orphan - used.begin()) + " belongs to no tetrahedron",
         "loose points; " + std::to_string(std::count(used.begin(), used.end(), false)) + " in all");
}

}  // namespace bodyopt
