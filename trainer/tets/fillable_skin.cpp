#include "trainer/tets/fillable_skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "base/disjoint_sets.h"
#include "geometry/mend_surface.h"
#include "geometry/nearest_skin.h"
#include "geometry/self_intersections.h"
#include "geometry/surface_topology.h"
#include "geometry/thickness.h"
#include "runtime/core/error.h"

namespace bodyopt::trainer {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;
using TrianglesAt = std::map<Edge, std::vector<Eigen::Index>>;

TrianglesAt triangles_at_edges(const Triangles& triangles, const std::vector<bool>& is_cut) {
  TrianglesAt at;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    if (is_cut[static_cast<std::size_t>(t)]) continue;
    for (int k = 0; k < 3; ++k) at[std::minmax(triangles(t, k), triangles(t, (k + 1) % 3))].push_back(t);
  }
  return at;
}

bool is_manifold(const TrianglesAt& at) {
  return std::ranges::all_of(at, [](const auto& edge) { return edge.second.size() <= 2; });
}

// The patch of every triangle: those that edges of two triangles join. It has the number of its first triangle.
std::vector<std::size_t> patches_of(const TrianglesAt& at, std::size_t triangles) {
  DisjointSets sets(triangles);
  for (const auto& [edge, around] : at) {
    if (around.size() == 2) sets.join(static_cast<std::size_t>(around[0]), static_cast<std::size_t>(around[1]));
  }
  std::vector<std::size_t> patch;
  for (std::size_t t = 0; t < triangles; ++t) patch.push_back(sets.lowest(t));
  return patch;
}

// The smallest patch with open edges that meets others; the number of triangles where there is none.
std::size_t smallest_sheet(const Positions& vertices, const Triangles& triangles, const TrianglesAt& at,
                           const std::vector<std::size_t>& patch) {
  std::vector<bool> is_open(patch.size(), false), meets_others(patch.size(), false);
  for (const auto& [edge, around] : at) {
    for (const Eigen::Index t : around) {
      const std::size_t of = patch[static_cast<std::size_t>(t)];
      if (around.size() == 1) is_open[of] = true;
      if (around.size() > 2) meets_others[of] = true;
    }
  }
  std::vector<double> area(patch.size(), 0);
  for (std::size_t t = 0; t < patch.size(); ++t) {
    area[patch[t]] += triangle_area(vertices, triangles, static_cast<Eigen::Index>(t));
  }
  std::size_t best = patch.size();
  for (std::size_t p = 0; p < patch.size(); ++p) {
    if (is_open[p] && meets_others[p] && (best == patch.size() || area[p] < area[best])) best = p;
  }
  return best;
}

constexpr double kMergeDistance = 1e-6;  // of the bounding box's diagonal
constexpr double kMostFilled = 0.2;      // of a piece's area: more is no hole, but an open sheet
constexpr double kSmallPiece = 0.01;     // of the largest piece's volume
constexpr double kLargePiece = 0.05;     // of the area of all: it is attached only where it follows the same joints
constexpr double kSameJoints = 0.5;      // of the weights, on the average
constexpr double kThinnest = 1e-3;       // volume over the power 3/2 of the area; a ball has 0.094

double area_of(const Positions& vertices, const Triangles& triangles) {
  double sum = 0;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) sum += triangle_area(vertices, triangles, t);
  return sum;
}

Triangles rows_of(const Triangles& triangles, const std::vector<Eigen::Index>& rows) {
  return triangles(rows, Eigen::all);
}

// Do the triangles use every edge once in each direction?
bool is_closed(const Triangles& triangles) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for_each_edge(triangles, [&](std::uint32_t a, std::uint32_t b) { edges.emplace(a, b); });
  return static_cast<Eigen::Index>(edges.size()) == triangles.size() && std::ranges::all_of(edges, [&](const auto& e) {
           return edges.contains({e.second, e.first});
         });
}

// The first of the vertices in one place on open edges, for every vertex.
std::vector<std::uint32_t> merge_open_edges(const Positions& vertices, const Triangles& triangles) {
  std::vector<std::uint32_t> first(static_cast<std::size_t>(vertices.rows())), open;
  std::iota(first.begin(), first.end(), 0u);
  std::vector<bool> is_open(first.size(), false);
  for (const auto& [a, b] : find_bad_edges(triangles).open) is_open[a] = is_open[b] = true;
  std::vector<Vec3> places;
  for (std::uint32_t v = 0; v < first.size(); ++v) {
    if (!is_open[v]) continue;
    open.push_back(v);
    places.push_back({vertices(v, 0), vertices(v, 1), vertices(v, 2)});
  }
  if (open.empty()) return first;
  const double diagonal = box_diagonal(vertices);
  const SkinWeights any(open.size());  // whatever their joints
  const std::optional<Weld> weld = weld_vertices(places, any, kMergeDistance * diagonal);
  if (!weld) return first;
  for (std::size_t k = 0; k < open.size(); ++k) first[open[k]] = open[weld->first[weld->welded_of[k]]];
  return first;
}

struct Piece {
  std::uint32_t first = 0;  // vertex
  std::vector<std::uint32_t> vertices;
  std::vector<Eigen::Index> triangles;
  double area = 0, volume = 0;  // volume: 0 where it is not closed
};

class SkinMender {
 public:
  SkinMender(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights)
      : vertices_(vertices), triangles_(triangles), weights_(weights) {
    if (vertices.rows() == 0 || triangles.rows() == 0)
      refuse(ErrorCause::no_faces, "it has no triangles (an empty mesh)");
    if (!vertices.allFinite()) refuse(ErrorCause::damaged, "a vertex is not a finite number (a damaged file)");
    if (static_cast<Eigen::Index>(triangles.maxCoeff()) >= vertices.rows()) {
      refuse(ErrorCause::damaged, "a triangle names a missing vertex (a damaged file)");
    }
  }

  FillableSkin mend(int room) {
    merge_and_drop();
    cut_sheets();
    result_.turned = wind_alike(triangles_);
    close_holes();
    find_pieces();
    choose_hosts();
    gather();
    result_.intersections = static_cast<Eigen::Index>(tangles_.size());
    const Positions before = result_.vertices;
    if (!untangle(result_.triangles, room, result_.vertices)) {
      refuse(ErrorCause::crossing, std::to_string(tangles_.size()) +
                                       " pairs of triangles intersect and cannot be moved apart, the first at vertex " +
                                       std::to_string(result_.tangled.front()));
    }
    result_.farthest = (result_.vertices - before).rowwise().norm().maxCoeff();
    return std::move(result_);
  }

 private:
  [[noreturn]] static void refuse(ErrorCause cause, const std::string& reason) {
    throw Error(ErrorKind::mismatch, "the skin encloses no volume to simulate: " + reason, cause);
  }

  void merge_and_drop() {
    first_ = merge_open_edges(vertices_, triangles_);
    std::set<std::array<std::uint32_t, 3>> seen;
    std::vector<Eigen::Index> kept;
    for (Eigen::Index t = 0; t < triangles_.rows(); ++t) {
      std::array<std::uint32_t, 3> corner{};
      for (int k = 0; k < 3; ++k) corner[static_cast<std::size_t>(k)] = triangles_(t, k) = first_[triangles_(t, k)];
      std::ranges::sort(corner);
      if (corner[0] == corner[1] || corner[1] == corner[2]) continue;
      if (seen.insert(corner).second) {
        kept.push_back(t);
      } else {
        ++result_.doubled;
      }
    }
    for (std::uint32_t v = 0; v < first_.size(); ++v) result_.merged += first_[v] != v ? 1 : 0;
    triangles_ = rows_of(triangles_, kept);
  }

  void cut_sheets() {
    const std::vector<bool> is_sheet = sheet_triangles(vertices_, triangles_);
    std::vector<Eigen::Index> kept, cut;
    for (Eigen::Index t = 0; t < triangles_.rows(); ++t) {
      (is_sheet[static_cast<std::size_t>(t)] ? cut : kept).push_back(t);
    }
    result_.cut = static_cast<Eigen::Index>(cut.size());
    if (cut.empty()) return;
    sheets_ = rows_of(triangles_, cut);
    triangles_ = rows_of(triangles_, kept);
  }

  // The triangles that join vertices: those that bound something, and what sheets are without the vertices they share.
  Triangles joining_triangles() const {
    std::vector<bool> is_shared(static_cast<std::size_t>(vertices_.rows()), false);
    for (Eigen::Index k = 0; k < triangles_.size(); ++k) is_shared[triangles_.data()[k]] = true;
    Triangles all(triangles_.rows() + sheets_.rows(), 3);
    Eigen::Index count = triangles_.rows();
    all.topRows(count) = triangles_;
    for (Eigen::Index t = 0; t < sheets_.rows(); ++t) {
      const auto corners = sheets_.row(t);
      const auto own = std::ranges::find_if(corners, [&](std::uint32_t v) { return !is_shared[v]; });
      if (own == corners.end()) continue;
      for (int k = 0; k < 3; ++k) all(count, k) = is_shared[corners[k]] ? *own : corners[k];
      ++count;
    }
    return all.topRows(count);
  }

  // Holes are filled, but not where a piece would be closed that is a sheet.
  void close_holes() {
    const Triangles added = fill_holes(vertices_, triangles_);
    if (added.rows() == 0) return;
    const SurfacePieces pieces = surface_pieces(vertices_.rows(), triangles_);
    std::vector<double> area(static_cast<std::size_t>(pieces.count), 0), hole(area);
    const auto add_area = [&](const Triangles& of, std::vector<double>& to) {
      for (Eigen::Index t = 0; t < of.rows(); ++t) {
        to[static_cast<std::size_t>(pieces.of_vertex[of(t, 0)])] += triangle_area(vertices_, of, t);
      }
    };
    add_area(triangles_, area);
    add_area(added, hole);
    std::vector<Eigen::Index> kept;
    for (Eigen::Index t = 0; t < added.rows(); ++t) {
      const auto piece = static_cast<std::size_t>(pieces.of_vertex[added(t, 0)]);
      if (hole[piece] < kMostFilled * area[piece]) kept.push_back(t);
    }
    result_.filled = static_cast<Eigen::Index>(kept.size());
    Triangles all(triangles_.rows() + result_.filled, 3);
    all << triangles_, rows_of(added, kept);
    triangles_ = all;
  }

  void find_pieces() {
    const SurfacePieces pieces = surface_pieces(vertices_.rows(), joining_triangles());
    piece_of_ = pieces.of_vertex;
    pieces_.resize(static_cast<std::size_t>(pieces.count));
    for (std::uint32_t v = 0; v < piece_of_.size(); ++v) piece(v).vertices.push_back(v);
    for (Piece& p : pieces_) p.first = p.vertices.front();
    for (Eigen::Index t = 0; t < triangles_.rows(); ++t) piece(triangles_(t, 0)).triangles.push_back(t);
    for (Piece& p : pieces_) {
      const Triangles own = rows_of(triangles_, p.triangles);
      p.area = area_of(vertices_, own);
      if (own.rows() == 0 || !is_closed(own)) continue;
      const double volume = enclosed_volume(vertices_, own);
      if (!(std::abs(volume) > kThinnest * std::pow(p.area, 1.5))) continue;
      p.volume = std::abs(volume);
      if (volume > 0) continue;
      for (const Eigen::Index t : p.triangles) std::swap(triangles_(t, 1), triangles_(t, 2));
    }
  }
  Piece& piece(std::uint32_t vertex) { return pieces_[static_cast<std::size_t>(piece_of_[vertex])]; }

  void choose_hosts() {
    std::vector<std::size_t> by_volume(pieces_.size());
    std::iota(by_volume.begin(), by_volume.end(), std::size_t{0});
    std::ranges::stable_sort(by_volume,
                             [&](std::size_t a, std::size_t b) { return pieces_[a].volume > pieces_[b].volume; });
    hosts_.assign(pieces_.size(), false);
    if (pieces_[by_volume.front()].volume == 0) refuse_open();
    hosts_[by_volume.front()] = true;
    renew_hosts();
    for (const std::size_t p : by_volume) {
      if (hosts_[p] || merged_away(p)) continue;
      const bool follows = follows_same_joints(p);
      const bool is_small = pieces_[p].volume < kSmallPiece * pieces_[by_volume.front()].volume;
      if (pieces_[p].volume > 0 && (!is_small || !follows) && !touches_hosts(p)) {
        hosts_[p] = true;
        renew_hosts();
        continue;
      }
      if (!follows && pieces_[p].area > kLargePiece * area_of(vertices_, triangles_)) {
        refuse(
            ErrorCause::large_piece,
            "a large piece, that of vertex " + std::to_string(pieces_[p].first) +
                ", passes through the others or is open, and follows other joints (pieces that belong together are to "
                "be joined)");
      }
      result_.loose_pieces.push_back(pieces_[p].first);
    }
  }
  [[noreturn]] void refuse_open() const {
    require_closed(vertices_, triangles_);  // names the defect
    refuse(ErrorCause::flat, "it is flat");
  }
  bool merged_away(std::size_t p) const { return first_[pieces_[p].first] != pieces_[p].first; }

  Triangles host_triangles() const {
    std::vector<Eigen::Index> rows;
    for (Eigen::Index t = 0; t < triangles_.rows(); ++t) {
      if (hosts_[static_cast<std::size_t>(piece_of_[triangles_(t, 0)])]) rows.push_back(t);
    }
    return rows_of(triangles_, rows);
  }

  void renew_hosts() {
    nearest_.reset();  // it refers to the triangles
    host_triangles_ = host_triangles();
    nearest_.emplace(vertices_, host_triangles_);
  }

  // Does a piece lie in the hosts, or pass through them?
  bool touches_hosts(std::size_t p) const {
    if (SkinDepth(vertices_, host_triangles_)(vertices_.row(pieces_[p].first)) > 0) return true;
    const Triangles own = rows_of(triangles_, pieces_[p].triangles);
    Triangles both(host_triangles_.rows() + own.rows(), 3);
    both << host_triangles_, own;
    const std::vector<TrianglePair> pairs = self_intersections(vertices_, both);
    return std::ranges::any_of(pairs, [&](const TrianglePair& pair) {
      return pair.first < host_triangles_.rows() && pair.second >= host_triangles_.rows();
    });
  }

  bool follows_same_joints(std::size_t p) const {
    double sum = 0;
    for (const std::uint32_t v : pieces_[p].vertices) {
      const SkinPoint at = (*nearest_)(vertices_.row(v));
      for (int k = 0; k < 3; ++k) {
        sum += at.weights[k] * shared_weight(weights_[v], weights_[at.vertices[static_cast<std::size_t>(k)]]);
      }
    }
    return sum >= kSameJoints * static_cast<double>(pieces_[p].vertices.size());
  }

  void gather() {
    const Triangles kept = host_triangles();
    result_.pieces = static_cast<int>(std::ranges::count(hosts_, true));
    result_.first = first_;
    result_.host.assign(static_cast<std::size_t>(vertices_.rows()), -1);
    for (std::uint32_t v = 0; v < result_.host.size(); ++v) {
      if (first_[v] != v) {
        result_.host[v] = result_.host[first_[v]];
      } else if (hosts_[static_cast<std::size_t>(piece_of_[v])]) {
        result_.host[v] = static_cast<int>(result_.vertex.size());
        result_.vertex.push_back(v);
      }
    }
    result_.vertices = vertices_(result_.vertex, Eigen::all);
    result_.triangles.resize(kept.rows(), 3);
    for (Eigen::Index k = 0; k < kept.size(); ++k) {
      result_.triangles.data()[k] = static_cast<std::uint32_t>(result_.host[kept.data()[k]]);
    }
    tangles_ = self_intersections(result_.vertices, result_.triangles);
    for (const std::uint32_t host : corners_of(tangles_, result_.triangles)) {
      result_.tangled.push_back(result_.vertex[host]);
    }
    std::ranges::sort(result_.tangled);
  }

  const Positions& vertices_;
  Triangles triangles_, sheets_;  // what may bound a volume; what was cut off
  const SkinWeights& weights_;
  std::vector<std::uint32_t> first_;
  std::vector<int> piece_of_;
  std::vector<Piece> pieces_;
  std::vector<bool> hosts_;
  Triangles host_triangles_;
  std::optional<NearestSkin> nearest_;  // of these
  std::vector<TrianglePair> tangles_;
  FillableSkin result_;
};

std::string counted(Eigen::Index count, const char* one, const char* many) {
  return std::to_string(count) + (count == 1 ? one : many);
}

}  // namespace

std::vector<bool> sheet_triangles(const Positions& vertices, const Triangles& triangles) {
  std::vector<bool> is_cut(static_cast<std::size_t>(triangles.rows()), false);
  for (;;) {
    const TrianglesAt at = triangles_at_edges(triangles, is_cut);
    if (is_manifold(at)) return is_cut;
    const std::vector<std::size_t> patch = patches_of(at, is_cut.size());
    const std::size_t sheet = smallest_sheet(vertices, triangles, at, patch);
    if (sheet == patch.size()) return is_cut;
    for (std::size_t t = 0; t < patch.size(); ++t) {
      if (patch[t] == sheet) is_cut[t] = true;
    }
  }
}

std::string FillableSkin::mending() const {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (merged > 0)
    add(counted(merged, " vertex joined to another in its place", " vertices joined to others in their place"));
  if (doubled > 0) add(counted(doubled, " doubled triangle dropped", " doubled triangles dropped"));
  if (cut > 0)
    add(counted(cut, " triangle of a sheet that bounds no volume cut off",
                " triangles of sheets that bound no volume cut off"));
  if (turned > 0) add(counted(turned, " flipped triangle turned", " flipped triangles turned"));
  if (filled > 0) add("holes filled with " + counted(filled, " triangle", " triangles"));
  if (intersections > 0) {
    add(counted(intersections, " pair of intersecting triangles moved apart",
                " pairs of intersecting triangles moved apart") +
        " (by " + std::to_string(static_cast<int>(std::ceil(1e4 * farthest)) / 10.0).substr(0, 4) + " mm at most)");
  }
  if (!loose_pieces.empty())
    add(counted(static_cast<Eigen::Index>(loose_pieces.size()), " loose piece follows", " loose pieces follow") +
        " the others");
  return text;
}

FillableSkin fillable_skin(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                           int room) {
  return SkinMender(vertices, triangles, weights).mend(room);
}

std::vector<EmbeddedPoint> own_nodes(const TetMesh& mesh, Eigen::Index vertices) {
  std::vector<EmbeddedPoint> points(static_cast<std::size_t>(vertices));
  for (Eigen::Index k = mesh.tets.size(); k-- > 0;) {  // backwards: the first tet of a node stays
    const int node = mesh.tets.data()[k];
    if (node < vertices)
      points[static_cast<std::size_t>(node)] = {static_cast<int>(k / 4), Eigen::Vector4d::Unit(k % 4)};
  }
  return points;
}

std::vector<EmbeddedPoint> carry_skin(const FillableSkin& fillable, const Positions& vertices, const TetMesh& mesh,
                                      const std::vector<EmbeddedPoint>& hosts) {
  std::vector<std::vector<int>> tets_at(static_cast<std::size_t>(mesh.nodes.rows()));
  for (int t = 0; t < mesh.tets.rows(); ++t) {
    for (int a = 0; a < 4; ++a) tets_at[static_cast<std::size_t>(mesh.tets(t, a))].push_back(t);
  }
  // The tet that holds a point best, among those around the tets that carry some hosts.
  const auto best_near = [&](const Eigen::RowVector3d& point, std::span<const std::uint32_t> near) {
    EmbeddedPoint best{hosts[near.front()].tet, Eigen::Vector4d::Constant(-1e300)};
    for (const std::uint32_t h : near) {
      for (int a = 0; a < 4; ++a) {
        for (const int t : tets_at[static_cast<std::size_t>(mesh.tets(hosts[h].tet, a))]) {
          const Eigen::Vector4d weights = weights_in(mesh, t, point);
          if (weights.minCoeff() > best.weights.minCoeff()) best = {t, weights};
        }
      }
    }
    return best;
  };
  const NearestSkin nearest(fillable.vertices, fillable.triangles);
  std::vector<EmbeddedPoint> points;
  for (std::size_t v = 0; v < fillable.host.size(); ++v) {
    const Eigen::RowVector3d place = vertices.row(static_cast<Eigen::Index>(v));
    const int host = fillable.host[v];
    if (host < 0) {
      points.push_back(best_near(place, nearest(place).vertices));
    } else if (fillable.vertices.row(host) == place) {
      points.push_back(hosts[static_cast<std::size_t>(host)]);
    } else {
      const auto h = static_cast<std::uint32_t>(host);
      points.push_back(best_near(place, {&h, 1}));
    }
  }
  return points;
}

}  // namespace bodyopt::trainer
