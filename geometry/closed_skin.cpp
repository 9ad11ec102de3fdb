#include "geometry/closed_skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <string>
#include <vector>

#include "geometry/bad_edges.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

[[noreturn]] void refuse(ErrorCause cause, const std::string& defect, const std::string& likely) {
  throw Error(ErrorKind::mismatch, "the skin encloses no volume to simulate: " + defect + " (" + likely + ")", cause);
}

}  // namespace

void require_closed(const Positions& vertices, const Triangles& triangles) {
  if (vertices.rows() == 0 || triangles.rows() == 0)
    refuse(ErrorCause::no_faces, "it has no triangles", "an empty mesh");
  if (!vertices.allFinite()) refuse(ErrorCause::damaged, "a vertex is not a finite number", "a damaged file");
  std::vector<bool> used(static_cast<std::size_t>(vertices.rows()), false);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (const std::uint32_t vertex : triangles.row(t)) {
      if (vertex >= used.size())
        refuse(ErrorCause::damaged, "triangle " + std::to_string(t) + " names a missing vertex", "a damaged file");
      used[vertex] = true;
    }
  }
  const auto [open, shared, flipped] = find_bad_edges(triangles);
  const auto loose = std::count(used.begin(), used.end(), false);
  const auto number = [](const std::vector<VertexPair>& edges) { return std::to_string(edges.size()); };
  if (!open.empty())
    refuse(ErrorCause::open_edges, "open: " + number(open) + " boundary edges", "holes, sheets or missing faces");
  if (!shared.empty())
    refuse(ErrorCause::crowded_edges, number(shared) + " edges join more than two triangles",
           "parts fused along an edge");
  if (!flipped.empty())
    refuse(ErrorCause::flipped_edges, number(flipped) + " edges join triangles that wind oppositely", "flipped faces");
  if (loose > 0)
    refuse(ErrorCause::loose_vertices, std::to_string(loose) + " vertices belong to no triangle",
           "loose points in the mesh");
}

double enclosed_volume(const Positions& vertices, const Triangles& triangles) {
  double six_volumes = 0;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::Vector3d a = vertices.row(triangles(t, 0)), b = vertices.row(triangles(t, 1)),
                          c = vertices.row(triangles(t, 2));
    six_volumes += a.cross(b).dot(c);
  }
  return six_volumes / 6;
}

double mean_edge(const Positions& vertices, const Triangles& triangles) {
  double sum = 0;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) sum += (vertices.row(triangles(t, k)) - vertices.row(triangles(t, (k + 1) % 3))).norm();
  }
  return sum / (3.0 * static_cast<double>(std::max<Eigen::Index>(triangles.rows(), 1)));
}

}  // namespace bodyopt
