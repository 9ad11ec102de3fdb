#include "trainer/tets/coarse_skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <optional>
#include <sstream>
#include <vector>

#include "geometry/closed_skin.h"
#include "geometry/remesh.h"
#include "geometry/self_intersections.h"
#include "geometry/thickness.h"
#include "geometry/vertex_normals.h"
#include "runtime/core/error.h"
#include "trainer/tets/tets.h"

namespace bodyopt {
namespace {

constexpr int kRemeshRounds = 8;
constexpr int kAttempts = 8, kMostRefused = 3;
constexpr double kLeastQuality = 0.05;
constexpr double kCloseEnough = 0.92;  // of what the limit allows
constexpr double kLittleFiner = 0.97;  // after a skin that cannot be filled
constexpr double kOnSkin = 0.8;        // about this share of the nodes
constexpr double kInside = 1.5;        // longest edges inside the body over those of the skin
constexpr double kTetsPerNode = 3.2;   // about

Triangles wound_outwards(const Positions& vertices, const Triangles& triangles) {
  require_closed(vertices, triangles);
  return enclosed_volume(vertices, triangles) < 0 ? triangles.rowwise().reverse().eval() : triangles;
}

CoarseSkin coarser(const FineSkin& fine, double scale) {
  Surface surface;
  for (Eigen::Index v = 0; v < fine.vertices.rows(); ++v) surface.points.push_back(fine.vertices.row(v));
  for (Eigen::Index t = 0; t < fine.triangles.rows(); ++t) {
    const auto corners = fine.triangles.row(t).cast<int>();
    surface.triangles.push_back({corners[0], corners[1], corners[2]});
  }
  surface = remesh(
      surface, [&](const Eigen::Vector3d& p) { return fine.nearest(p).position; },
      [&](const Eigen::Vector3d& p) { return scale * fine.edge_at(p); }, kRemeshRounds);
  CoarseSkin skin{Positions(static_cast<Eigen::Index>(surface.points.size()), 3),
                  Triangles(static_cast<Eigen::Index>(surface.triangles.size()), 3)};
  for (Eigen::Index v = 0; v < skin.vertices.rows(); ++v) {
    skin.vertices.row(v) = surface.points[static_cast<std::size_t>(v)].transpose();
  }
  for (Eigen::Index t = 0; t < skin.triangles.rows(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      skin.triangles(t, static_cast<Eigen::Index>(k)) =
          static_cast<std::uint32_t>(surface.triangles[static_cast<std::size_t>(t)][k]);
    }
  }
  return skin;
}

void require_quality(const TetMesh& mesh) {
  if (mesh.worst_quality >= kLeastQuality) return;
  throw Error(ErrorKind::mismatch, "its worst tetrahedron has a quality of " + std::to_string(mesh.worst_quality));
}

// Of the fine skin, in squared edges.
double relative_area(const FineSkin& fine) {
  double sum = 0;
  for (Eigen::Index t = 0; t < fine.triangles.rows(); ++t) {
    const auto corner = fine.triangles.row(t);
    const Eigen::Vector3d a = fine.vertices.row(corner[0]), b = fine.vertices.row(corner[1]),
                          c = fine.vertices.row(corner[2]);
    const double edge = (fine.edge[corner[0]] + fine.edge[corner[1]] + fine.edge[corner[2]]) / 3;
    sum += (b - a).cross(c - a).norm() / 2 / (edge * edge);
  }
  return sum;
}

// Empty where it does not pass through itself.
std::string where_it_passes_through_itself(const CoarseSkin& skin) {
  const std::vector<TrianglePair> pairs = self_intersections(skin.vertices, skin.triangles);
  if (pairs.empty()) return "";
  const Eigen::RowVector3d place = skin.vertices.row(skin.triangles(pairs.front().first, 0));
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << "; the coarser skin passes through itself at " << place << " m";
  return text.str();
}

double share_of(const FillLimit& limit, const TetMesh& mesh) {
  return std::max(static_cast<double>(mesh.nodes.rows()) / static_cast<double>(limit.nodes),
                  static_cast<double>(mesh.tets.rows()) / static_cast<double>(limit.tets));
}

}  // namespace

FineSkin::FineSkin(const Positions& v, const Triangles& wound)
    : vertices(v),
      triangles(wound_outwards(v, wound)),
      normals(vertex_normals(v, triangles)),
      edge(thickness(v, triangles).cwiseSqrt()),
      nearest(v, triangles) {}

double FineSkin::edge_at(const Eigen::Vector3d& point) const {
  const SkinPoint at = nearest(point);
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += at.weights[k] * edge[at.vertices[static_cast<std::size_t>(k)]];
  return sum;
}

FilledSkin fill_coarser(const FineSkin& fine, FillLimit limit, const std::function<void(CoarseSkin&)>& adjust) {
  limit.nodes = std::min(limit.nodes, static_cast<Eigen::Index>(static_cast<double>(fine.vertices.rows()) / kOnSkin));
  const double nodes = std::min(static_cast<double>(limit.nodes), static_cast<double>(limit.tets) / kTetsPerNode);
  // A node of a skin of regular triangles has sqrt(3) / 2 squared edges of it.
  double scale = std::sqrt(relative_area(fine) / (kOnSkin * nodes * std::sqrt(3) / 2));
  if (!(scale > 0)) throw Error(ErrorKind::mismatch, "the skin has no area");
  std::optional<FilledSkin> best;
  double best_share = 0;
  std::string refusal = "every one tried had too many nodes or tetrahedra";
  ErrorCause cause = ErrorCause::other;
  int refused = 0;
  for (int attempt = 0; attempt < kAttempts && refused < kMostRefused; ++attempt) {
    CoarseSkin skin = coarser(fine, scale);
    adjust(skin);
    try {
      TetMesh mesh = tetrahedralise(skin.vertices, skin.triangles, kInside * scale * fine.edge.maxCoeff());
      require_quality(mesh);
      const double share = share_of(limit, mesh);
      if (share <= 1 && share > best_share) {
        best = FilledSkin{std::move(skin), std::move(mesh)};
        best_share = share;
      }
      if (share <= 1 && share > kCloseEnough) break;
      scale *= std::sqrt(share / (0.5 + 0.5 * kCloseEnough));
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::mismatch && error.kind() != ErrorKind::usage) throw;  // too fine, or not filled
      refusal = error.what() + where_it_passes_through_itself(skin);
      cause = error.cause();
      ++refused;
      scale *= kLittleFiner;
    }
  }
  if (!best) throw Error(ErrorKind::mismatch, "no coarser skin can be filled: " + refusal, cause);
  return std::move(*best);
}

}  // namespace bodyopt
