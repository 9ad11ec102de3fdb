#include "trainer/tets/skin_cage.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "runtime/basis/error.h"
#include "trainer/dataset/vertex_normals.h"
#include "trainer/tets/closed_skin.h"
#include "trainer/tets/nearest_skin.h"
#include "trainer/tets/remesh.h"
#include "trainer/tets/tet_finder.h"
#include "trainer/tets/thickness.h"

namespace bodyopt {
namespace {

constexpr int kRemeshRounds = 8;
constexpr int kSampleRows = 3;  // samples along a tet's edge, less one
constexpr int kFitRounds = 2;
constexpr int kAttempts = 8, kMostRefused = 3;
constexpr double kLeastQuality = 0.05;
constexpr double kCloseEnough = 0.92;  // of the nodes allowed
constexpr double kLittleFiner = 0.97;  // after a skin that cannot be filled
constexpr double kOnSkin = 0.8;        // about this share of the nodes
constexpr double kInside = 1.5;        // longest edges inside the body over those of the skin

struct Skin {
  Positions vertices;
  Triangles triangles;
};

// The fine skin, and how long the edges of a coarser one should be at each of its vertices, relative to each other: by
// the root of the body's thickness there. Equal edges leave limbs of a few tets, which hardly bend; edges as long as
// the body is thick spend all nodes on the fingers.
struct FineSkin {
  const Positions& vertices;
  const Triangles& triangles;
  Positions normals;
  Eigen::VectorXd edge;
  NearestSkin nearest;

  FineSkin(const Positions& v, const Triangles& t)
      : vertices(v), triangles(t), normals(vertex_normals(v, t)), edge(thickness(v, t).cwiseSqrt()), nearest(v, t) {}
  double edge_at(const Eigen::Vector3d& point) const {
    const SkinPoint at = nearest(point);
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += at.weights[k] * edge[at.vertices[static_cast<std::size_t>(k)]];
    return sum;
  }
};

Skin coarser(const FineSkin& fine, double scale) {
  Surface surface;
  for (Eigen::Index v = 0; v < fine.vertices.rows(); ++v) surface.points.push_back(fine.vertices.row(v));
  for (Eigen::Index t = 0; t < fine.triangles.rows(); ++t) {
    const auto corners = fine.triangles.row(t).cast<int>();
    surface.triangles.push_back({corners[0], corners[1], corners[2]});
  }
  surface = remesh(
      surface, [&](const Eigen::Vector3d& p) { return fine.nearest(p).position; },
      [&](const Eigen::Vector3d& p) { return scale * fine.edge_at(p); }, kRemeshRounds);
  Skin skin{Positions(static_cast<Eigen::Index>(surface.points.size()), 3),
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

// Moves the coarser skin, whose chords lie inside bends, outwards until as much of the fine skin is inside it as
// outside.
void fit(const FineSkin& fine, Skin& coarse) {
  for (int round = 0; round < kFitRounds; ++round) {
    const NearestSkin nearest(coarse.vertices, coarse.triangles);
    Positions sum = Positions::Zero(coarse.vertices.rows(), 3);
    Eigen::VectorXd weight = Eigen::VectorXd::Zero(coarse.vertices.rows());
    for (Eigen::Index v = 0; v < fine.vertices.rows(); ++v) {
      const SkinPoint near = nearest.facing(fine.vertices.row(v), fine.normals.row(v));
      if (near.triangle < 0) continue;
      for (int k = 0; k < 3; ++k) {
        sum.row(near.vertices[static_cast<std::size_t>(k)]) +=
            near.weights[k] * (fine.vertices.row(v) - near.position.transpose());
        weight[near.vertices[static_cast<std::size_t>(k)]] += near.weights[k];
      }
    }
    for (Eigen::Index n = 0; n < weight.size(); ++n) {
      if (weight[n] > 0) coarse.vertices.row(n) += sum.row(n) / weight[n];
    }
  }
}

void require_quality(const TetMesh& mesh) {
  if (mesh.worst_quality >= kLeastQuality) return;
  throw Error(ErrorKind::mismatch, "its worst tetrahedron has a quality of " + std::to_string(mesh.worst_quality));
}

Cage cage_of(const FineSkin& fine, const Skin& surface, TetMesh mesh) {
  Cage cage;
  cage.mesh = std::move(mesh);
  const TetFinder find(cage.mesh, surface.vertices, surface.triangles);
  for (Eigen::Index v = 0; v < fine.vertices.rows(); ++v) {
    cage.skin.push_back(find(fine.vertices.row(v), fine.normals.row(v)));
  }
  const std::vector<Eigen::Vector4d> lattice = tet_lattice(kSampleRows);
  for (int t = 0; t < cage.mesh.tets.rows(); ++t) {
    const double volume = tet_edges(cage.mesh, t).determinant() / 6 / static_cast<double>(lattice.size());
    for (const Eigen::Vector4d& weights : lattice) cage.samples.push_back({{t, weights}, volume});
  }
  return cage;
}

}  // namespace

Cage skin_cage(const Positions& vertices, const Triangles& wound, Eigen::Index max_nodes) {
  require_closed(vertices, wound);
  const Triangles triangles = enclosed_volume(vertices, wound) < 0 ? wound.rowwise().reverse().eval() : wound;
  max_nodes = std::min(max_nodes, static_cast<Eigen::Index>(static_cast<double>(vertices.rows()) / kOnSkin));
  const FineSkin fine(vertices, triangles);
  double relative_area = 0;  // of the skin, in squared edges
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::Vector3d a = vertices.row(triangles(t, 0)), b = vertices.row(triangles(t, 1)),
                          c = vertices.row(triangles(t, 2));
    const double edge = (fine.edge[triangles(t, 0)] + fine.edge[triangles(t, 1)] + fine.edge[triangles(t, 2)]) / 3;
    relative_area += (b - a).cross(c - a).norm() / 2 / (edge * edge);
  }
  // A node of a skin of regular triangles has sqrt(3) / 2 squared edges of it.
  double scale = std::sqrt(relative_area / (kOnSkin * static_cast<double>(max_nodes) * std::sqrt(3) / 2));
  if (!(scale > 0)) throw Error(ErrorKind::mismatch, "the skin has no area");
  std::optional<std::pair<Skin, TetMesh>> best;
  std::string refusal = "every one tried had more nodes than " + std::to_string(max_nodes);
  int refused = 0;
  for (int attempt = 0; attempt < kAttempts && refused < kMostRefused; ++attempt) {
    Skin surface = coarser(fine, scale);
    fit(fine, surface);
    try {
      TetMesh mesh = tetrahedralise(surface.vertices, surface.triangles, kInside * scale * fine.edge.maxCoeff());
      require_quality(mesh);
      const double share = static_cast<double>(mesh.nodes.rows()) / static_cast<double>(max_nodes);
      if (share <= 1 && (!best || mesh.nodes.rows() > best->second.nodes.rows())) {
        best.emplace(std::move(surface), std::move(mesh));
      }
      if (share <= 1 && share > kCloseEnough) break;
      scale *= std::sqrt(share / (0.5 + 0.5 * kCloseEnough));
    } catch (const Error& error) {
      refusal = error.what();
      ++refused;
      scale *= kLittleFiner;
    }
  }
  if (!best) throw Error(ErrorKind::mismatch, "no coarser skin can be filled: " + refusal);
  return cage_of(fine, best->first, std::move(best->second));
}

}  // namespace bodyopt
