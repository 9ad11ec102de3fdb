#include "geometry/wind_alike.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace bodyopt {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

std::map<Edge, std::vector<Eigen::Index>> triangles_of_edges(const Triangles& triangles) {
  std::map<Edge, std::vector<Eigen::Index>> result;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) result[std::minmax(triangles(t, k), triangles(t, (k + 1) % 3))].push_back(t);
  }
  return result;
}

bool runs_through(const Triangles& triangles, Eigen::Index t, Edge edge) {
  for (int k = 0; k < 3; ++k) {
    if (Edge(triangles(t, k), triangles(t, (k + 1) % 3)) == edge) return true;
  }
  return false;
}

}  // namespace

Eigen::Index wind_alike(Triangles& triangles) {
  const std::map<Edge, std::vector<Eigen::Index>> of_edge = triangles_of_edges(triangles);
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
        const Edge edge(triangles(part[at], k), triangles(part[at], (k + 1) % 3));
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
