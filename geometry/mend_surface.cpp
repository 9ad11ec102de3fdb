#include "geometry/mend_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "geometry/self_intersections.h"
#include "geometry/surface_topology.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

using Loop = std::vector<std::uint32_t>;
using DirectedEdges = std::set<std::pair<std::uint32_t, std::uint32_t>>;
using Corners = std::array<std::uint32_t, 3>;

constexpr std::size_t kLongestLoop = 200;

DirectedEdges directed_edges(const Triangles& triangles) {
  DirectedEdges edges;
  for_each_edge(triangles, [&](std::uint32_t a, std::uint32_t b) { edges.emplace(a, b); });
  return edges;
}

// Loops around every hole, as the triangles that close it run. Where two holes meet in a vertex they are two loops.
std::vector<Loop> hole_loops(const DirectedEdges& edges) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> next;
  for (const auto& [a, b] : edges) {
    if (!edges.contains({b, a})) next[b].push_back(a);
  }
  std::vector<Loop> loops;
  for (auto& [start, ends] : next) {
    Loop walked{start};
    while (!walked.empty() && !next[walked.back()].empty()) {
      const std::uint32_t to = next[walked.back()].back();
      next[walked.back()].pop_back();
      const auto before = std::ranges::find(walked, to);
      if (before == walked.end()) {
        walked.push_back(to);
        continue;
      }
      loops.emplace_back(before, walked.end());
      walked.erase(before + 1, walked.end());
    }
  }
  return loops;
}

// The triangles of the smallest area in a loop; none where there are none.
class SmallestArea {
 public:
  SmallestArea(const Positions& vertices, const DirectedEdges& edges, const Loop& loop)
      : vertices_(vertices), edges_(edges), loop_(loop), area_(loop.size() * loop.size(), 0), apex_(area_.size(), 0) {}

  std::vector<Corners> find() {
    const std::size_t n = loop_.size();
    for (std::size_t width = 2; width < n; ++width) {
      for (std::size_t from = 0; from + width < n; ++from) choose_apex(from, from + width);
    }
    std::vector<Corners> triangles;
    if (area_[n - 1] < std::numeric_limits<double>::infinity()) collect(0, n - 1, triangles);
    return triangles;
  }

 private:
  void choose_apex(std::size_t from, std::size_t to) {
    double& least = area_[from * loop_.size() + to];
    least = std::numeric_limits<double>::infinity();
    const bool closes = from == 0 && to + 1 == loop_.size();
    if (!closes && is_edge(loop_[from], loop_[to])) return;  // it would be used a third time
    for (std::size_t k = from + 1; k < to; ++k) {
      const double area = area_[from * loop_.size() + k] + area_[k * loop_.size() + to] + triangle_area(from, k, to);
      if (!(area < least)) continue;
      least = area;
      apex_[from * loop_.size() + to] = k;
    }
  }
  bool is_edge(std::uint32_t a, std::uint32_t b) const { return edges_.contains({a, b}) || edges_.contains({b, a}); }
  double triangle_area(std::size_t i, std::size_t k, std::size_t j) const {
    const Eigen::Vector3d a = vertices_.row(loop_[i]), b = vertices_.row(loop_[k]), c = vertices_.row(loop_[j]);
    return (b - a).cross(c - a).norm() / 2;
  }
  void collect(std::size_t from, std::size_t to, std::vector<Corners>& triangles) const {
    if (to - from < 2) return;
    const std::size_t k = apex_[from * loop_.size() + to];
    triangles.push_back({loop_[from], loop_[k], loop_[to]});
    collect(from, k, triangles);
    collect(k, to, triangles);
  }

  const Positions& vertices_;
  const DirectedEdges& edges_;
  const Loop& loop_;
  std::vector<double> area_;
  std::vector<std::size_t> apex_;
};

std::map<VertexPair, std::vector<Eigen::Index>> triangles_of_edges(const Triangles& triangles) {
  std::map<VertexPair, std::vector<Eigen::Index>> result;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) result[std::minmax(triangles(t, k), triangles(t, (k + 1) % 3))].push_back(t);
  }
  return result;
}

bool runs_through(const Triangles& triangles, Eigen::Index t, VertexPair edge) {
  for (int k = 0; k < 3; ++k) {
    if (VertexPair(triangles(t, k), triangles(t, (k + 1) % 3)) == edge) return true;
  }
  return false;
}

[[noreturn]] void refuse(ErrorCause cause, const std::string& defect, const std::string& likely) {
  throw Error(ErrorKind::mismatch, "the skin encloses no volume to simulate: " + defect + " (" + likely + ")", cause);
}

constexpr int kRounds = 60, kRoundsPerRing = 12;
constexpr int kHalvings = 4;         // of a step, before it is given up
constexpr double kRoom = 2;          // a step is taken that may be so many times as long
constexpr double kInwards = 0.05;    // of the mean edge around a vertex, a round
constexpr double kSmoothing = 0.15;  // of the way to the middle of its neighbours, a round

std::vector<std::vector<std::uint32_t>> neighbours_of(Eigen::Index vertices, const Triangles& triangles) {
  std::vector<std::vector<std::uint32_t>> result(static_cast<std::size_t>(vertices));
  for_each_edge(triangles, [&](std::uint32_t a, std::uint32_t b) { result[a].push_back(b); });
  return result;
}

void mark_corners(const Triangles& triangles, const std::vector<TrianglePair>& pairs, std::vector<bool>& marked) {
  for (const std::uint32_t corner : corners_of(pairs, triangles)) marked[corner] = true;
}

void mark_ring(const std::vector<std::vector<std::uint32_t>>& neighbours, std::vector<bool>& marked) {
  const std::vector<bool> before = marked;
  for (std::size_t v = 0; v < marked.size(); ++v) {
    if (!before[v]) continue;
    for (const std::uint32_t n : neighbours[v]) marked[n] = true;
  }
}

Positions stepped(const Positions& vertices, const Triangles& triangles,
                  const std::vector<std::vector<std::uint32_t>>& neighbours, const std::vector<bool>& marked) {
  const Positions normals = vertex_normals(vertices, triangles);
  Positions result = vertices;
  for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
    const std::vector<std::uint32_t>& around = neighbours[static_cast<std::size_t>(v)];
    if (!marked[static_cast<std::size_t>(v)] || around.empty()) continue;
    Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
    double edge = 0;
    for (const std::uint32_t n : around) {
      middle += vertices.row(n) / static_cast<double>(around.size());
      edge += (vertices.row(n) - vertices.row(v)).norm() / static_cast<double>(around.size());
    }
    result.row(v) += kSmoothing * (middle - vertices.row(v)) - kInwards * edge * normals.row(v);
  }
  return result;
}

// So many steps, but none into another intersection.
void make_room(const Triangles& triangles, const std::vector<std::vector<std::uint32_t>>& neighbours,
               const std::vector<bool>& marked, int steps, Positions& vertices) {
  for (int step = 0; step < steps; ++step) {
    const Positions further = stepped(vertices, triangles, neighbours, marked);
    if (!self_intersections(further, triangles).empty()) return;
    vertices = further;
  }
}

}  // namespace

Triangles fill_holes(const Positions& vertices, const Triangles& triangles) {
  const DirectedEdges edges = directed_edges(triangles);
  std::vector<Corners> added;
  for (const Loop& loop : hole_loops(edges)) {
    if (loop.size() < 3 || loop.size() > kLongestLoop) continue;
    const std::vector<Corners> closing = SmallestArea(vertices, edges, loop).find();
    added.insert(added.end(), closing.begin(), closing.end());
  }
  return triangles_of(added);
}

Eigen::Index wind_alike(Triangles& triangles) {
  const std::map<VertexPair, std::vector<Eigen::Index>> of_edge = triangles_of_edges(triangles);
  std::vector<bool> seen(static_cast<std::size_t>(triangles.rows()), false), turned(seen);
  Eigen::Index count = 0;
  const auto turn = [&](Eigen::Index t) {
    turned[static_cast<std::size_t>(t)] = !turned[static_cast<std::size_t>(t)];
    std::swap(triangles(t, 1), triangles(t, 2));
  };
  for (Eigen::Index seed = 0; seed < triangles.rows(); ++seed) {
    if (seen[static_cast<std::size_t>(seed)]) continue;
    seen[static_cast<std::size_t>(seed)] = true;
    std::vector<Eigen::Index> part{seed};
    for (std::size_t at = 0; at < part.size(); ++at) {
      for (int k = 0; k < 3; ++k) {
        const VertexPair edge(triangles(part[at], k), triangles(part[at], (k + 1) % 3));
        const std::vector<Eigen::Index>& sharing = of_edge.at(std::minmax(edge.first, edge.second));
        if (sharing.size() != 2) continue;
        const Eigen::Index other = sharing[0] == part[at] ? sharing[1] : sharing[0];
        if (seen[static_cast<std::size_t>(other)]) continue;
        seen[static_cast<std::size_t>(other)] = true;
        if (runs_through(triangles, other, edge)) turn(other);
        part.push_back(other);
      }
    }
    const auto is_turned = [&](Eigen::Index t) { return turned[static_cast<std::size_t>(t)]; };
    auto changed = std::ranges::count_if(part, is_turned);
    const auto all = static_cast<std::ptrdiff_t>(part.size());
    if (2 * changed > all) {
      for (const Eigen::Index t : part) turn(t);
      changed = all - changed;
    }
    count += changed;
  }
  return count;
}

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
  const auto loose = std::ranges::count(used, false);
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
    const auto [a, b, c] = corners_of(vertices, triangles, t);
    six_volumes += a.cross(b).dot(c);
  }
  return six_volumes / 6;
}

double mean_edge(const Positions& vertices, const Triangles& triangles) {
  double sum = 0;
  for_each_edge(triangles, [&](auto a, auto b) { sum += (vertices.row(a) - vertices.row(b)).norm(); });
  return sum / (3.0 * static_cast<double>(std::max<Eigen::Index>(triangles.rows(), 1)));
}

bool untangle(const Triangles& triangles, int room, Positions& vertices) {
  const auto neighbours = neighbours_of(vertices.rows(), triangles);
  std::vector<bool> marked(static_cast<std::size_t>(vertices.rows()), false);
  Positions moved = vertices;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<TrianglePair> pairs = self_intersections(moved, triangles);
    if (pairs.empty()) {
      if (round > 0) make_room(triangles, neighbours, marked, room, moved);
      vertices = moved;
      return true;
    }
    mark_corners(triangles, pairs, marked);
    if (round % kRoundsPerRing == 0) mark_ring(neighbours, marked);
    moved = stepped(moved, triangles, neighbours, marked);
  }
  return false;
}

void step_apart(const Triangles& triangles, Positions steps, Positions& vertices) {
  bool are_apart = false;
  for (int round = 0; !are_apart; ++round) {
    std::vector<bool> marked(static_cast<std::size_t>(vertices.rows()), false);
    for (const double far : {1.0, kRoom}) {
      mark_corners(triangles, self_intersections(vertices + far * steps, triangles), marked);
    }
    are_apart = true;
    for (Eigen::Index v = 0; v < steps.rows(); ++v) {
      if (!marked[static_cast<std::size_t>(v)] || steps.row(v).isZero(0)) continue;
      steps.row(v) *= round < kHalvings ? 0.5 : 0.0;
      are_apart = false;
    }
  }
  vertices += steps;
}

}  // namespace bodyopt
