#include "trainer/dynamics/dynamics_tets.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <set>

#include "base/progress.h"
#include "geometry/mend_surface.h"
#include "geometry/mesh.h"
#include "runtime/basis/dynamics.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "trainer/dynamics/jiggle_fields.h"
#include "trainer/tets/tets.h"

namespace bodyopt::trainer {
namespace {

// Flatter tets give no inverse in single precision that is worth its name.
constexpr double kFlat = 1e-4;

[[noreturn]] void refuse(const std::string& what, const std::string& cause) {
  throw Error(ErrorKind::mismatch, "the tetrahedra cannot carry finite elements: ", what, " (", cause, ")");
}

std::string name_of(Eigen::Index tet) { return "tetrahedron " + std::to_string(tet); }

constexpr int kRounds = 8;
// Signed shapes (below): what is asked of a tet in every pose and at rest, and below which its nodes are moved.
constexpr double kWanted = 0.03, kWantedAtRest = 0.05, kNearlyFlat = 0.01;
// Search steps over the mean edge at a node.
constexpr double kFirstStep = 0.4, kLastStep = 0.02;
constexpr double kWorthwhile = 0.999;  // a step lowers what is wanting below this times what it was

// Neighbouring poses are looked at together, as lanes of the processor: a point in each of them, one a row.
constexpr Eigen::Index kTogether = 8;
template <typename Number>
using Points = Eigen::Array<Number, kTogether, 3>;
using Point = Eigen::Array<double, 1, 3>;

// Points in all poses, one point a row: x of eight poses, y, z, then the next eight. What is over at the end is zero.
NodeValues posed_points(const std::vector<Positions>& poses, const std::vector<std::uint32_t>& vertices) {
  const auto count = static_cast<Eigen::Index>(poses.size());
  NodeValues points = NodeValues::Zero(static_cast<Eigen::Index>(vertices.size()),
                                       3 * kTogether * ((count + kTogether - 1) / kTogether));
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    for (Eigen::Index f = 0; f < count; ++f) {
      for (int axis = 0; axis < 3; ++axis) {
        points(v, 3 * kTogether * (f / kTogether) + kTogether * axis + f % kTogether) =
            poses[static_cast<std::size_t>(f)](vertices[static_cast<std::size_t>(v)], axis);
      }
    }
  }
  return points;
}

Eigen::Map<const Points<double>> in_poses(const NodeValues& points, Eigen::Index row, Eigen::Index block) {
  return Eigen::Map<const Points<double>>(points.row(row).data() + 3 * kTogether * block);
}

// Six times the signed volume over the cubed root mean square of the edges: 1 regular, 0 flat, negative inside out. A
// number for each row of the corners.
template <typename Corner>
auto signed_shape(const Corner& origin, const Corner& x, const Corner& y, const Corner& z) {
  using Number = typename Corner::Scalar;
  using Lanes = Eigen::Array<Number, Corner::RowsAtCompileTime, 1>;
  const Corner a = x - origin, b = y - origin, c = z - origin, d = y - x, e = z - x, f = z - y;
  const Lanes squares = (a * a + b * b + c * c + d * d + e * e + f * f).rowwise().sum() / 6;
  const Lanes volume = a.col(0) * (b.col(1) * c.col(2) - b.col(2) * c.col(1)) +
                       a.col(1) * (b.col(2) * c.col(0) - b.col(0) * c.col(2)) +
                       a.col(2) * (b.col(0) * c.col(1) - b.col(1) * c.col(0));
  const Lanes shape = std::numbers::sqrt2_v<Number> * volume / (squares * squares.sqrt());
  return Lanes((squares > 0).select(shape, Lanes::Zero()));
}

// The tets around a node: corners are indices into `ring`, -1 the node itself.
struct Star {
  std::vector<int> ring;
  std::vector<std::array<int, 4>> tets;
  std::vector<double> least_at_rest;  // signed shapes
  std::vector<Point> rest;            // of the ring
  std::vector<Points<float>> posed;   // of the ring, from where the node is; in each block of poses
  std::vector<std::size_t> blocks;    // those where the tets are flattest come first
  double edge = 0;                    // mean, metres
  double wanting = 0;                 // with the node where it is
};

template <typename Corner>
auto signed_shape(const std::array<int, 4>& tet, const Corner* ring, const Corner& node) {
  const auto corner = [&](const int k) -> const Corner& { return k < 0 ? node : ring[k]; };
  return signed_shape(corner(tet[0]), corner(tet[1]), corner(tet[2]), corner(tet[3]));
}

// A place for a node at rest, and whose sum it is in the poses: of its ring, or of vertices of the skin.
struct Place {
  Point rest;
  Eigen::VectorXd shares;  // of the ring
  SkinPoint on_skin;
};

class Unfolder {
 public:
  // skin_poses: of the vertices of the skin, in so many poses.
  Unfolder(const NearestSkin& skin, const NodeValues& skin_poses, Eigen::Index poses, Eigen::Index surface,
           bool may_slide, TetMesh& mesh)
      : skin_(skin), skin_poses_(skin_poses), poses_(poses), surface_(surface), may_slide_(may_slide), mesh_(mesh) {
    tets_of_.resize(static_cast<std::size_t>(mesh.nodes.rows()));
    for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
      for (int a = 0; a < 4; ++a) tets_of_[static_cast<std::size_t>(mesh.tets(t, a))].push_back(t);
    }
  }

  Unfolding run() {
    Progress progress("unfold", kRounds);
    Unfolding result;
    result.poses = poses_;
    Positions best = mesh_.nodes;
    for (int round = 0;; ++round) {
      carry();
      const Eigen::Index inverted = find_flat();
      if (round == 0) result.before = result.after = inverted;
      if (inverted < result.after) {
        result.after = inverted;
        best = mesh_.nodes;
      }
      if (flat_.empty() || round == kRounds) break;
      for (const int node : nodes_to_move()) improve(node);
      progress.advance();
    }
    mesh_.nodes = best;
    return result;
  }

 private:
  // Poses the nodes by skin and diffuse.
  void carry() {
    NodeValues on_surface(surface_, skin_poses_.cols());
    for (Eigen::Index n = 0; n < surface_; ++n) on_surface.row(n) = at_point(skin_poses_, skin_(mesh_.nodes.row(n)));
    posed_ = diffuse(mesh_, on_surface);
  }

  Eigen::Index blocks() const { return skin_poses_.cols() / (3 * kTogether); }
  Eigen::Index poses_in(Eigen::Index block) const { return std::min(kTogether, poses_ - kTogether * block); }

  // Notes the tets that are nearly flat in a pose; counts those inside out in all of them.
  Eigen::Index find_flat() {
    flat_.clear();
    Eigen::Index inverted = 0;
    for (Eigen::Index t = 0; t < mesh_.tets.rows(); ++t) {
      for (Eigen::Index b = 0; b < blocks(); ++b) {
        std::array<Points<double>, 4> x;
        for (int a = 0; a < 4; ++a) x[static_cast<std::size_t>(a)] = in_poses(posed_, mesh_.tets(t, a), b);
        const auto shapes = signed_shape(x[0], x[1], x[2], x[3]);
        if ((shapes.head(poses_in(b)) < kNearlyFlat).any()) flat_.insert(t);
        inverted += (shapes.head(poses_in(b)) <= 0).count();
      }
    }
    return inverted;
  }

  // Returns the nodes of flat tets and, inside, their neighbours. Nodes inside come first: the skin changes last.
  std::set<int, std::greater<>> nodes_to_move() const {
    std::set<int, std::greater<>> nodes;
    for (const Eigen::Index flat : flat_) {
      for (const int node : mesh_.tets.row(flat)) {
        if (node >= surface_ || may_slide_) nodes.insert(node);
        for (const Eigen::Index t : tets_of_[static_cast<std::size_t>(node)]) {
          for (const int other : mesh_.tets.row(t)) {
            if (other >= surface_) nodes.insert(other);
          }
        }
      }
    }
    return nodes;
  }

  Star star_of(int node) const {
    Star star;
    for (const Eigen::Index t : tets_of_[static_cast<std::size_t>(node)]) {
      std::array<int, 4> tet{};
      for (int a = 0; a < 4; ++a) {
        const int other = mesh_.tets(t, a);
        const auto found = std::ranges::find(star.ring, other);
        tet[static_cast<std::size_t>(a)] = other == node ? -1 : static_cast<int>(found - star.ring.begin());
        if (other != node && found == star.ring.end()) star.ring.push_back(other);
      }
      star.tets.push_back(tet);
    }
    const Point here = mesh_.nodes.row(node);
    for (const int other : star.ring) {
      star.rest.emplace_back(mesh_.nodes.row(other));
      star.edge += (star.rest.back() - here).matrix().norm() / static_cast<double>(star.ring.size());
    }
    for (const std::array<int, 4>& tet : star.tets) {
      star.least_at_rest.push_back(std::min(kWantedAtRest, signed_shape(tet, star.rest.data(), here).value()));
    }
    look_at_poses(node, star);
    return star;
  }

  void look_at_poses(int node, Star& star) const {
    std::vector<double> wants;
    for (Eigen::Index b = 0; b < blocks(); ++b) {
      const Points<double> here = in_poses(posed_, node, b);
      for (const int other : star.ring) star.posed.emplace_back((in_poses(posed_, other, b) - here).cast<float>());
      star.blocks.push_back(static_cast<std::size_t>(b));
      wants.push_back(wanting(star, star.blocks.back(), Points<float>::Zero()));
      star.wanting += wants.back();
    }
    std::ranges::stable_sort(star.blocks, std::greater<>(), [&](const std::size_t b) { return wants[b]; });
  }

  // Returns the weights by which diffuse poses a node inside from its neighbours: the node's row of the Laplacian.
  static Eigen::VectorXd shares_of_ring(const Star& star, const Point& rest) {
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(star.ring.size()));
    for (const std::array<int, 4>& tet : star.tets) {
      const auto corner = [&](const int k) -> const Point& { return k < 0 ? rest : star.rest[k]; };
      Eigen::Matrix3d edges;
      for (int k = 0; k < 3; ++k) edges.col(k) = corner(tet[static_cast<std::size_t>(k) + 1]) - corner(tet[0]);
      const Eigen::Matrix<double, 4, 3> slopes = corner_slopes(edges);
      const auto own = std::ranges::find(tet, -1) - tet.begin();
      for (std::size_t k = 0; k < 4; ++k) {
        if (tet[k] < 0) continue;
        weights[tet[k]] -= edges.determinant() * slopes.row(own).dot(slopes.row(static_cast<Eigen::Index>(k)));
      }
    }
    return weights / weights.sum();
  }

  Place place(int node, const Star& star, const Point& wanted) const {
    if (node >= surface_) return {wanted, shares_of_ring(star, wanted), {}};
    const SkinPoint point = skin_(wanted.matrix().transpose());
    return {point.position.transpose().array(), {}, point};
  }

  // Returns how far `place` moves the node in the poses of the block.
  Points<float> posed(int node, const Star& star, const Place& place, std::size_t block) const {
    if (node < surface_) {
      const auto b = static_cast<Eigen::Index>(block);
      Points<double> sum = -in_poses(posed_, node, b);
      for (int k = 0; k < 3; ++k) {
        sum += place.on_skin.weights[k] * in_poses(skin_poses_, place.on_skin.vertices[static_cast<std::size_t>(k)], b);
      }
      return sum.cast<float>();
    }
    Points<float> sum = Points<float>::Zero();
    const Points<float>* const ring = star.posed.data() + block * star.ring.size();
    for (Eigen::Index k = 0; k < place.shares.size(); ++k) sum += static_cast<float>(place.shares[k]) * ring[k];
    return sum;
  }

  // Returns by how much the star's tets are flatter than wanted, summed over the poses of a block.
  double wanting(const Star& star, std::size_t block, const Points<float>& node) const {
    const Points<float>* const ring = star.posed.data() + block * star.ring.size();
    Eigen::Array<float, kTogether, 1> sum = Eigen::Array<float, kTogether, 1>::Zero();
    for (const std::array<int, 4>& tet : star.tets) {
      sum += (static_cast<float>(kWanted) - signed_shape(tet, ring, node)).max(0.0F);
    }
    return sum.head(poses_in(static_cast<Eigen::Index>(block))).sum();
  }

  // Returns the sum over all blocks, or some number of at least `most` where the sum exceeds that.
  double wanting(int node, const Star& star, const Place& place, double most) const {
    for (std::size_t t = 0; t < star.tets.size(); ++t) {
      if (signed_shape(star.tets[t], star.rest.data(), place.rest).value() < star.least_at_rest[t]) return most;
    }
    double sum = 0;
    for (const std::size_t block : star.blocks) {
      sum += wanting(star, block, posed(node, star, place, block));
      if (sum >= most) break;
    }
    return sum;
  }

  // Compass search (Hooke and Jeeves 1961) along axes and diagonals.
  void improve(int node) {
    const Star star = star_of(node);
    Place best{mesh_.nodes.row(node), {}, {}};
    double least = star.wanting;
    for (double step = kFirstStep; least > 0 && step > kLastStep;) {
      bool better = false;
      for (int k = 0; k < 27 && least > 0; ++k) {
        if (k == 13) continue;
        const Eigen::RowVector3d way = Eigen::RowVector3d(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1).normalized();
        Place tried = place(node, star, best.rest + step * star.edge * way.array());
        const double wants = wanting(node, star, tried, kWorthwhile * least);
        if (wants >= kWorthwhile * least) continue;
        least = wants;
        best = std::move(tried);
        better = true;
      }
      if (!better) step /= 2;
    }
    if (least == star.wanting) return;
    mesh_.nodes.row(node) = best.rest;
    if (node < surface_) {
      posed_.row(node) = at_point(skin_poses_, best.on_skin);
      return;
    }
    posed_.row(node).setZero();
    for (std::size_t k = 0; k < star.ring.size(); ++k) {
      posed_.row(node) += best.shares[static_cast<Eigen::Index>(k)] * posed_.row(star.ring[k]);
    }
  }

  const NearestSkin& skin_;
  const NodeValues& skin_poses_;
  const Eigen::Index poses_, surface_;
  const bool may_slide_;
  TetMesh& mesh_;
  std::vector<std::vector<Eigen::Index>> tets_of_;
  NodeValues posed_;  // of the nodes
  std::set<Eigen::Index> flat_;
};

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
    const auto s = static_cast<std::size_t>(n);
    const bool is_on =
        s < tets.surface.size() && (at_point(vertices, tets.surface[s]) - mesh.nodes.row(n)).norm() <= near;
    (is_on ? on : off).push_back(n);
  }
  tets.surface = transformed(on, [&](const int n) { return tets.surface[static_cast<std::size_t>(n)]; });
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

// Harmonic interpolation is not injective: behind a fold of the skin it may turn tets inside out. Optimisation-based
// smoothing (Freitag and Ollivier-Gooch 1997) moves their nodes at rest, one by one, to improve the tets around them in
// the poses. Nodes inside move freely. The first `surface` nodes lie on the skin and slide along it if they
// `may_slide`. No tet gets flat at rest. It ends when no tet is inside out or after a few rounds, with the best found.
// A function of its arguments alone. skin: of these vertices at rest; poses: V x 3 each.
Unfolding unfold_tets(const FineSkin& skin, const std::vector<Positions>& poses,
                      const std::vector<std::uint32_t>& vertices, Eigen::Index surface, bool may_slide, TetMesh& mesh) {
  if (poses.empty()) return {};
  const Unfolding result =
      Unfolder(skin.nearest, posed_points(poses, vertices), std::ssize(poses), surface, may_slide, mesh).run();
  orient(mesh);  // the worst quality
  return result;
}

}  // namespace

TetQuality tet_quality(const TetMesh& mesh) {
  std::vector<double> quality;
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) quality.push_back(mean_ratio(mesh, t));
  if (quality.empty()) return {};
  std::ranges::sort(quality);
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
  const auto orphan = std::ranges::find(used, false);
  if (orphan == used.end()) return;
  refuse("node " + std::to_string(orphan - used.begin()) + " belongs to no tetrahedron",
         "loose points; " + std::to_string(std::ranges::count(used, false)) + " in all");
}

DynamicsTets make_dynamics_tets(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                                Eigen::Index most_tets, const std::vector<Positions>& poses) {
  const FillableSkin fillable = fillable_skin(vertices, triangles, weights);
  const FineSkin fine(fillable.vertices, fillable.triangles);
  std::optional<FilledSkin> own = fill_as_it_is(fine, most_tets);
  FilledSkin filled = own ? std::move(*own) : fill_coarser(fine, {.tets = most_tets}, [](CoarseSkin&) {});
  // The nodes of a skin that is taken as it is are its vertices.
  const Unfolding unfolding = unfold_tets(fine, poses, fillable.vertex, filled.skin.vertices.rows(), !own, filled.mesh);
  // Everything is computed from the nodes in the runtime's single precision.
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
  // Loose pieces swing with the places that hold them.
  Positions places = vertices;
  const LoosePieces loose_pieces(fillable, vertices, triangles, weights);
  places(loose_pieces.vertices(), Eigen::all) = loose_pieces.spread(vertices);
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

}  // namespace bodyopt::trainer
