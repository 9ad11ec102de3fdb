#include "geometry/surface_topology.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <unordered_map>

#include "base/disjoint_sets.h"

namespace bodyopt {
namespace {

constexpr double kWeightTolerance = 1e-4;
constexpr int kMaxComparisons = 4096;
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

bool same_weights(const std::vector<JointWeight>& a, const std::vector<JointWeight>& b) {
  std::size_t i = 0, k = 0;
  while (i < a.size() || k < b.size()) {
    const std::uint32_t joint_a = i < a.size() ? a[i].joint : kNone, joint_b = k < b.size() ? b[k].joint : kNone;
    const double weight_a = joint_a <= joint_b ? a[i++].weight : 0, weight_b = joint_b <= joint_a ? b[k++].weight : 0;
    if (std::abs(weight_a - weight_b) > kWeightTolerance) return false;
  }
  return true;
}

bool same_position(const Vec3& a, const Vec3& b, double tolerance) {
  return std::abs(a[0] - b[0]) <= tolerance && std::abs(a[1] - b[1]) <= tolerance && std::abs(a[2] - b[2]) <= tolerance;
}

// A grid of cells wider than the tolerance: a vertex's duplicates lie in its own cell or, near a border, the next.
class Grid {
 public:
  Grid(std::span<const Vec3> positions, double tolerance) : tolerance_(tolerance), low_(positions[0]) {
    for (const Vec3& p : positions) {
      for (std::size_t i = 0; i < 3; ++i) low_[i] = std::min(low_[i], p[i]);
    }
  }

  // Calls visit(entry) for what may be within the tolerance of p until it returns true.
  template <class Visit>
  bool any_near(const Vec3& p, Visit visit) const {
    std::uint64_t from[3], to[3];
    for (std::size_t i = 0; i < 3; ++i) {
      from[i] = cell(p[i] - tolerance_, i);
      to[i] = cell(p[i] + tolerance_, i);
    }
    for (std::uint64_t x = from[0]; x <= to[0]; ++x) {
      for (std::uint64_t y = from[1]; y <= to[1]; ++y) {
        for (std::uint64_t z = from[2]; z <= to[2]; ++z) {
          const auto head = heads_.find(key(x, y, z));
          if (head == heads_.end()) continue;
          for (std::uint32_t entry = head->second; entry != kNone; entry = next_[entry]) {
            if (visit(entry)) return true;
          }
        }
      }
    }
    return false;
  }

  void add(const Vec3& p, std::uint32_t entry) {
    const auto [head, is_new] = heads_.try_emplace(key(cell(p[0], 0), cell(p[1], 1), cell(p[2], 2)), entry);
    next_.push_back(is_new ? kNone : head->second);
    head->second = entry;
  }

 private:
  // One cell is to spare below, for p - tolerance.
  std::uint64_t cell(double x, std::size_t axis) const {
    return static_cast<std::uint64_t>(std::floor((x - low_[axis]) / (8 * tolerance_)) + 1);
  }
  static std::uint64_t key(std::uint64_t x, std::uint64_t y, std::uint64_t z) { return x | y << 21 | z << 42; }

  double tolerance_;
  Vec3 low_;
  std::unordered_map<std::uint64_t, std::uint32_t> heads_;
  std::vector<std::uint32_t> next_;  // per entry, in the order added
};

}  // namespace

std::optional<Weld> weld_vertices(std::span<const Vec3> positions, std::span<const std::vector<JointWeight>> weights,
                                  double tolerance) {
  Weld weld;
  Grid grid(positions, tolerance);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    std::uint32_t match = kNone;
    int comparisons = 0;
    grid.any_near(positions[i], [&](std::uint32_t candidate) {
      const std::uint32_t v = weld.first[candidate];
      if (same_position(positions[i], positions[v], tolerance) && same_weights(weights[i], weights[v]))
        match = candidate;
      return match != kNone || ++comparisons > kMaxComparisons;
    });
    if (comparisons > kMaxComparisons) return std::nullopt;
    if (match == kNone) {
      match = static_cast<std::uint32_t>(weld.first.size());
      weld.first.push_back(static_cast<std::uint32_t>(i));
      grid.add(positions[i], match);
    }
    weld.welded_of.push_back(match);
  }
  return weld;
}

SurfacePieces surface_pieces(Eigen::Index vertices, const Triangles& triangles) {
  const auto count = static_cast<std::size_t>(vertices);
  DisjointSets sets(count);
  for_each_edge(triangles, [&](std::uint32_t a, std::uint32_t b) { sets.join(a, b); });
  SurfacePieces pieces;
  for (std::size_t v = 0; v < count; ++v) {
    const std::size_t first = sets.lowest(v);
    pieces.of_vertex.push_back(first == v ? pieces.count++ : pieces.of_vertex[first]);
  }
  return pieces;
}

BadEdges find_bad_edges(const Triangles& triangles) {
  struct Use {
    int forward = 0, backward = 0;
  };
  std::map<VertexPair, Use> edges;
  for_each_edge(triangles, [&](std::uint32_t a, std::uint32_t b) {
    Use& use = edges[std::minmax(a, b)];
    (a < b ? use.forward : use.backward)++;
  });
  BadEdges bad;
  for (const auto& [edge, use] : edges) {
    const int count = use.forward + use.backward;
    if (count == 1) bad.open.push_back(edge);
    if (count > 2) bad.shared.push_back(edge);
    if (count == 2 && use.forward != use.backward) bad.flipped.push_back(edge);
  }
  return bad;
}

Triangles each_once(const Triangles& triangles) {
  std::set<std::array<std::uint32_t, 3>> known;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    std::array<std::uint32_t, 3> corners = {triangles(t, 0), triangles(t, 1), triangles(t, 2)};
    std::ranges::sort(corners);
    if (known.insert(corners).second) kept.push_back(t);
  }
  return triangles(kept, Eigen::all);
}

}  // namespace bodyopt
