#include "trainer/dynamics/dynamics_tets.h"

#include <Eigen/LU>
#include <optional>

#include "geometry/closed_skin.h"
#include "geometry/extent.h"
#include "runtime/basis/dynamics.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "trainer/dynamics/tet_quality.h"
#include "trainer/tets/skin_cage.h"
#include "trainer/tets/tets.h"

namespace bodyopt {
namespace {

// A skin's own filling has about four tets a vertex. More than this many vertices per tet allowed need not be tried.
constexpr double kMostVerticesPerTet = 0.35;
constexpr double kLeastQuality = 0.05;  // of the skin's own filling; fill_coarser asks for as much
constexpr double kInside = 3;           // longest edges inside the body over the mean of the skin's

constexpr double kOnSkin = 1e-6;  // of the body's extent; the basis' single precision is as coarse

// The skin itself, filled; nothing where that takes too many tets or comes out badly.
std::optional<FilledSkin> fill_as_it_is(const FineSkin& fine, Eigen::Index most_tets) {
  if (static_cast<double>(fine.vertices.rows()) > kMostVerticesPerTet * static_cast<double>(most_tets)) return {};
  try {
    FilledSkin filled{{fine.vertices, fine.triangles}, {}};
    filled.mesh = tetrahedralise(fine.vertices, fine.triangles, kInside * mean_edge(fine.vertices, fine.triangles));
    const bool good = filled.mesh.tets.rows() <= most_tets && filled.mesh.worst_quality >= kLeastQuality;
    return good ? std::optional(std::move(filled)) : std::nullopt;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::mismatch) throw;
    return {};
  }
}

// Nodes that are vertices are carried by these alone.
void surface_of_own_nodes(DynamicsTets& tets) {
  for (std::size_t v = 0; v < tets.surface.size(); ++v) {
    const auto vertex = static_cast<std::uint32_t>(v);
    tets.surface[v].vertices = {vertex, vertex, vertex};
    tets.surface[v].weights = {1, 0, 0};
  }
}

// Beyond its tet a vertex would swing further than what carries it, outside a flat one many times as far. It is carried
// from the point on the line to the tet's middle where no weight is lower than this.
constexpr double kLeastWeight = -0.3;

void bring_near(std::vector<EmbeddedPoint>& skin) {
  constexpr double kMiddle = 0.25;
  for (EmbeddedPoint& point : skin) {
    const double least = point.weights.minCoeff();
    if (least >= kLeastWeight) continue;
    point.weights = (point.weights.array() - kMiddle) * (kMiddle - kLeastWeight) / (kMiddle - least) + kMiddle;
  }
}

// Nodes of the mended surface that are not where the skin is do not lie on it: they are put among those inside.
void keep_on_skin(const Positions& vertices, DynamicsTets& tets) {
  TetMesh& mesh = tets.cage.mesh;
  const double near = kOnSkin * longest_extent(vertices);
  std::vector<int> on, off;
  for (int n = 0; n < mesh.nodes.rows(); ++n) {
    bool is_on = static_cast<std::size_t>(n) < tets.surface.size();
    if (is_on) {
      const SkinPoint& point = tets.surface[static_cast<std::size_t>(n)];
      Eigen::RowVector3d place = Eigen::RowVector3d::Zero();
      for (int k = 0; k < 3; ++k) place += point.weights[k] * vertices.row(point.vertices[static_cast<std::size_t>(k)]);
      is_on = (place - mesh.nodes.row(n)).norm() <= near;
    }
    (is_on ? on : off).push_back(n);
  }
  tets.surface = [&] {
    return transformed(on, [&](const int n) { return tets.surface[static_cast<std::size_t>(n)]; });
  }();
  std::vector<int> order = on;
  order.insert(order.end(), off.begin(), off.end());
  std::vector<int> number(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) number[static_cast<std::size_t>(order[k])] = static_cast<int>(k);
  mesh.nodes = mesh.nodes(order, Eigen::all).eval();
  for (Eigen::Index k = 0; k < mesh.tets.size(); ++k) {
    mesh.tets.data()[k] = number[static_cast<std::size_t>(mesh.tets.data()[k])];
  }
}

TetShape shape_of(const TetMesh& mesh, Eigen::Index tet) {
  const Eigen::Matrix3d edges = tet_edges(mesh, tet), inverse = edges.inverse();
  TetShape shape{};
  for (int i = 0; i < 9; ++i) shape.inverse_edges[i] = static_cast<float>(inverse(i / 3, i % 3));
  shape.volume = static_cast<float>(edges.determinant() / 6);
  return shape;
}

SurfacePoint packed(const SkinPoint& point) {
  const auto f = [](double x) { return static_cast<float>(x); };
  return {point.vertices[0],   point.vertices[1],   point.vertices[2],
          f(point.weights[0]), f(point.weights[1]), f(point.weights[2])};
}

TetPoint packed(const EmbeddedPoint& point, double amount) {
  const auto f = [](double x) { return static_cast<float>(x); };
  return {static_cast<std::uint32_t>(point.tet),
          f(point.weights[0]),
          f(point.weights[1]),
          f(point.weights[2]),
          f(point.weights[3]),
          f(amount)};
}

}  // namespace

DynamicsTets make_dynamics_tets(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                                Eigen::Index most_tets, const std::vector<Positions>& poses) {
  const FillableSkin fillable = fillable_skin(vertices, triangles, weights);
  const FineSkin fine(fillable.vertices, fillable.triangles);
  std::optional<FilledSkin> own = fill_as_it_is(fine, most_tets);
  FilledSkin filled = own ? std::move(*own) : fill_coarser(fine, {.tets = most_tets}, [](CoarseSkin&) {});
  std::vector<Positions> filled_poses;
  for (const Positions& pose : poses) filled_poses.push_back(pose(fillable.vertex, Eigen::all));
  // The nodes of a skin that is taken as it is are its vertices.
  const Unfolding unfolding = unfold_tets(fine.nearest, filled_poses, filled.skin.vertices.rows(), !own, filled.mesh);
  // What the runtime has; everything is computed from it.
  filled.mesh.nodes = filled.mesh.nodes.cast<float>().cast<double>().eval();
  filled.skin.vertices = filled.mesh.nodes.topRows(filled.skin.vertices.rows());
  require_sound(filled.mesh);
  DynamicsTets tets{cage_in(fine, filled), {}, unfolding};
  for (Eigen::Index n = 0; n < filled.skin.vertices.rows(); ++n) {
    tets.surface.push_back(fine.nearest(filled.skin.vertices.row(n)));
  }
  if (own) {
    surface_of_own_nodes(tets);
    tets.cage.skin = own_nodes(tets.cage.mesh, fine.vertices.rows());
  }
  // What rides swings with the places that hold it.
  Positions places = vertices;
  const Riders riders(fillable, vertices, triangles, weights);
  places(riders.vertices(), Eigen::all) = riders.spread(vertices);
  tets.cage.skin = carry_skin(fillable, places, tets.cage.mesh, tets.cage.skin);
  tets.cage.mending = fillable.mending();
  for (SkinPoint& point : tets.surface) {
    for (std::uint32_t& vertex : point.vertices) vertex = fillable.vertex[vertex];
  }
  if (fillable.farthest > 0) keep_on_skin(vertices, tets);
  bring_near(tets.cage.skin);
  return tets;
}

TetTable make_tet_table(const DynamicsTets& tets, const std::vector<double>& amounts,
                        const std::vector<double>& limits) {
  const TetMesh& mesh = tets.cage.mesh;
  TetTable table;
  table.nodes.assign(mesh.nodes.data(), mesh.nodes.data() + mesh.nodes.size());
  table.tets.assign(mesh.tets.data(), mesh.tets.data() + mesh.tets.size());
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) table.shapes.push_back(shape_of(mesh, t));
  std::vector<std::vector<std::uint32_t>> corners(static_cast<std::size_t>(mesh.nodes.rows()));
  for (std::uint32_t k = 0; k < table.tets.size(); ++k) corners[table.tets[k]].push_back(k);
  table.corner_begin.push_back(0);
  for (const std::vector<std::uint32_t>& at_node : corners) {
    table.corners.insert(table.corners.end(), at_node.begin(), at_node.end());
    table.corner_begin.push_back(static_cast<std::uint32_t>(table.corners.size()));
  }
  for (const SkinPoint& point : tets.surface) table.surface.push_back(packed(point));
  for (std::size_t v = 0; v < tets.cage.skin.size(); ++v) {
    table.skin.push_back(packed(tets.cage.skin[v], amounts[v]));
  }
  table.skin_limit.assign(limits.begin(), limits.end());
  return table;
}

}  // namespace bodyopt
