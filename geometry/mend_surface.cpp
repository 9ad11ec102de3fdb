#include "geometry/mend_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace bodyopt {
namespace {

using Loop = std::vector<std::uint32_t>;
using DirectedEdges = std::set<std::pair<std::uint32_t, std::uint32_t>>;
using Corners = std::array<std::uint32_t, 3>;

constexpr std::size_t kLongestLoop = 200;

DirectedEdges directed_edges(const Triangles& triangles) {
  DirectedEdges edges;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) edges.emplace(triangles(t, k), triangles(t, (k + 1) % 3));
  }
  return edges;
}

// Around every hole, as the triangles that close it run. Where two holes meet in a vertex they are two loops.
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
      const auto before = std::find(walked.begin(), walked.end(), to);
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

using VertexPair = std::pair<std::uint32_t, std::uint32_t>;

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

}  // namespace

Triangles fill_holes(const Positions& vertices, const Triangles& triangles) {
  const DirectedEdges edges = directed_edges(triangles);
  std::vector<Corners> added;
  for (const Loop& loop : hole_loops(edges)) {
    if (loop.size() < 3 || loop.size() > kLongestLoop) continue;
    const std::vector<Corners> closing = SmallestArea(vertices, edges, loop).find();
    added.insert(added.end(), closing.begin(), closing.end());
  }
  Triangles result(static_cast<Eigen::Index>(added.size()), 3);
  for (std::size_t t = 0; t < added.size(); ++t) {
    result.row(static_cast<Eigen::Index>(t)) << added[t][0], added[t][1], added[t][2];
  }
  return result;
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
    auto changed = std::count_if(part.begin(), part.end(), is_turned);
    const auto all = static_cast<std::ptrdiff_t>(part.size());
    if (2 * changed > all) {
      for (const Eigen::Index t : part) turn(t);
      changed = all - changed;
    }
    count += changed;
  }
  return count;
}

}  // namespace bodyopt
