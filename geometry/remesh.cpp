#include "geometry/remesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <compare>
#include <iterator>

namespace bodyopt {
namespace {

using Eigen::Vector3d;

struct Edge {
  double ratio;  // length over wanted length
  int a, b;
  auto operator<=>(const Edge&) const = default;
};

class Remesher {
 public:
  Remesher(Surface surface, const Project& project, const EdgeLength& edge_length)
      : points_(std::move(surface.points)),
        triangles_(std::move(surface.triangles)),
        project_(project),
        edge_length_(edge_length),
        around_(points_.size()) {
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      for (const int v : triangles_[t]) around_[v].push_back(static_cast<int>(t));
    }
    for (const Vector3d& p : points_) wanted_.push_back(edge_length_(p));
  }

  void round() {
    split_long();
    collapse_short();
    flip([this](const Flip& f) { return valence_gain(f) > 0; });
    relax();
  }

  void polish() {
    flip([this](const Flip& f) { return quality_gain(f) > 1e-3; });
    relax();
  }

  Surface take() const {
    Surface surface;
    std::vector<int> renumbered(points_.size(), -1);
    for (const auto& triangle : triangles_) {
      if (triangle[0] < 0) continue;
      std::array<int, 3> kept;
      for (int k = 0; k < 3; ++k) {
        int& n = renumbered[triangle[k]];
        if (n < 0) {
          n = static_cast<int>(surface.points.size());
          surface.points.push_back(points_[triangle[k]]);
        }
        kept[k] = n;
      }
      surface.triangles.push_back(kept);
    }
    return surface;
  }

 private:
  // The edge a-b between triangles (a, b, c) and (b, a, d) becomes c-d.
  struct Flip {
    int a, b, c, d;
  };

  double ratio(int a, int b) const { return (points_[a] - points_[b]).norm() / (0.5 * (wanted_[a] + wanted_[b])); }

  std::vector<Edge> edges() const {
    std::vector<Edge> all;
    for (const auto& t : triangles_) {
      if (t[0] < 0) continue;
      for (int k = 0; k < 3; ++k) {
        const int a = t[k], b = t[(k + 1) % 3];
        if (a < b) all.push_back({ratio(a, b), a, b});
      }
    }
    std::ranges::sort(all);
    return all;
  }

  // The triangle that has the directed edge a-b, or -1.
  int triangle_of(int a, int b) const {
    for (const int t : around_[a]) {
      for (int k = 0; k < 3; ++k) {
        if (triangles_[t][k] == a && triangles_[t][(k + 1) % 3] == b) return t;
      }
    }
    return -1;
  }

  int opposite(int t, int a, int b) const { return triangles_[t][0] + triangles_[t][1] + triangles_[t][2] - a - b; }

  std::vector<int> neighbours(int v) const {
    std::vector<int> all;
    for (const int t : around_[v]) {
      for (int k = 0; k < 3; ++k) {
        if (triangles_[t][k] == v) all.push_back(triangles_[t][(k + 1) % 3]);
      }
    }
    std::ranges::sort(all);
    return all;
  }

  Vector3d normal(const Vector3d& a, const Vector3d& b, const Vector3d& c) const { return (b - a).cross(c - a); }

  void detach(int t, int v) { std::erase(around_[v], t); }

  void replace(int t, int from, int to) {
    *std::ranges::find(triangles_[t], from) = to;
    detach(t, from);
    around_[to].push_back(t);
  }

  void split_long() {
    std::vector<Edge> all = edges();
    std::ranges::reverse(all);
    for (const Edge& e : all) {
      if (e.ratio < 4.0 / 3) break;
      const int left = triangle_of(e.a, e.b), right = triangle_of(e.b, e.a);
      const int c = opposite(left, e.a, e.b), d = opposite(right, e.a, e.b);
      const int m = static_cast<int>(points_.size());
      points_.push_back(0.5 * (points_[e.a] + points_[e.b]));
      wanted_.push_back(edge_length_(points_[m]));
      around_.emplace_back();
      replace(left, e.b, m);   // a m c
      replace(right, e.b, m);  // m a d
      add({m, e.b, c});
      add({e.b, m, d});
    }
  }

  void add(const std::array<int, 3>& triangle) {
    for (const int v : triangle) around_[v].push_back(static_cast<int>(triangles_.size()));
    triangles_.push_back(triangle);
  }

  void collapse_short() {
    for (const Edge& e : edges()) {
      if (e.ratio > 4.0 / 5) break;
      if (can_collapse(e.a, e.b)) collapse(e.a, e.b);
    }
  }

  bool can_collapse(int a, int b) const {
    if (around_[a].empty() || around_[b].empty()) return false;
    const int left = triangle_of(a, b), right = triangle_of(b, a);
    if (left < 0 || right < 0) return false;
    const std::vector<int> near_a = neighbours(a), near_b = neighbours(b);
    std::vector<int> common;
    std::set_intersection(near_a.begin(), near_a.end(), near_b.begin(), near_b.end(), std::back_inserter(common));
    // Only the two shared triangles may vanish, and no point may be left with two triangles.
    if (common.size() != 2 || around_[common[0]].size() < 5 || around_[common[1]].size() < 5) return false;
    const Vector3d middle = 0.5 * (points_[a] + points_[b]);
    return keeps_shape(a, b, middle) && keeps_shape(b, a, middle);
  }

  bool keeps_shape(int v, int other, const Vector3d& target) const {
    for (const int t : around_[v]) {
      Vector3d before[3], after[3];
      bool vanishes = false;
      for (int k = 0; k < 3; ++k) {
        const int w = triangles_[t][k];
        vanishes = vanishes || w == other;
        before[k] = points_[w];
        after[k] = w == v ? target : points_[w];
        if (w != v && (target - points_[w]).norm() > 4.0 / 3 * wanted_[w]) return false;
      }
      if (vanishes) continue;
      const Vector3d n = normal(before[0], before[1], before[2]), m = normal(after[0], after[1], after[2]);
      if (n.dot(m) < 0.5 * n.norm() * m.norm()) return false;
    }
    return true;
  }

  void collapse(int a, int b) {
    points_[a] = 0.5 * (points_[a] + points_[b]);
    wanted_[a] = edge_length_(points_[a]);
    for (const int t : {triangle_of(a, b), triangle_of(b, a)}) {
      for (const int v : triangles_[t]) detach(t, v);
      triangles_[t] = {-1, -1, -1};
    }
    for (const int t : std::vector<int>(around_[b])) replace(t, b, a);
  }

  template <typename Wanted>
  void flip(const Wanted& wanted) {
    for (const Edge& e : edges()) {
      const int left = triangle_of(e.a, e.b), right = triangle_of(e.b, e.a);
      if (left < 0 || right < 0) continue;
      const Flip f{e.a, e.b, opposite(left, e.a, e.b), opposite(right, e.a, e.b)};
      if (!can_flip(f) || !wanted(f)) continue;
      replace(left, f.b, f.d);   // a d c
      replace(right, f.a, f.c);  // b c d
    }
  }

  bool can_flip(const Flip& f) const {
    if (around_[f.a].size() < 4 || around_[f.b].size() < 4) return false;
    if (triangle_of(f.c, f.d) >= 0 || triangle_of(f.d, f.c) >= 0) return false;
    const Vector3d &a = points_[f.a], &b = points_[f.b], &c = points_[f.c], &d = points_[f.d];
    const Vector3d before = normal(a, b, c).normalized() + normal(b, a, d).normalized();
    const Vector3d left = normal(a, d, c), right = normal(b, c, d);
    const double flat = 0.8 * before.norm();
    return left.dot(before) > flat * left.norm() && right.dot(before) > flat * right.norm();
  }

  int valence_gain(const Flip& f) const {
    const auto cost = [this](int v, int change) {
      const int off = static_cast<int>(around_[v].size()) + change - 6;
      return off * off;
    };
    return cost(f.a, 0) + cost(f.b, 0) + cost(f.c, 0) + cost(f.d, 0) - cost(f.a, -1) - cost(f.b, -1) - cost(f.c, 1) -
           cost(f.d, 1);
  }

  // Area over the edges' squared lengths: 1 for an equilateral triangle, 0 for a flat one.
  double quality(int u, int v, int w) const {
    const Vector3d &a = points_[u], &b = points_[v], &c = points_[w];
    return 2 * std::sqrt(3.0) * normal(a, b, c).norm() /
           ((a - b).squaredNorm() + (b - c).squaredNorm() + (c - a).squaredNorm());
  }

  double quality_gain(const Flip& f) const {
    return std::min(quality(f.a, f.d, f.c), quality(f.b, f.c, f.d)) -
           std::min(quality(f.a, f.b, f.c), quality(f.b, f.a, f.d));
  }

  // Each point goes to the centre of its triangles, small ones counting more where small ones are wanted.
  void relax() {
    std::vector<Vector3d> moved = points_;
    for (std::size_t v = 0; v < points_.size(); ++v) {
      if (around_[v].empty()) continue;
      Vector3d sum = Vector3d::Zero(), up = Vector3d::Zero();
      double weight = 0;
      for (const int t : around_[v]) {
        const auto& tri = triangles_[t];
        const Vector3d n = normal(points_[tri[0]], points_[tri[1]], points_[tri[2]]);
        const double size = (wanted_[tri[0]] + wanted_[tri[1]] + wanted_[tri[2]]) / 3;
        const double w = n.norm() / (size * size * size * size);
        sum += w / 3 * (points_[tri[0]] + points_[tri[1]] + points_[tri[2]]);
        weight += w;
        up += n;
      }
      if (!(weight > 0)) continue;  // all flat
      up.normalize();
      const Vector3d step = sum / weight - points_[v];
      moved[v] = project_(points_[v] + step - up.dot(step) * up);
    }
    points_ = std::move(moved);
    for (std::size_t v = 0; v < points_.size(); ++v) wanted_[v] = edge_length_(points_[v]);
  }

  std::vector<Vector3d> points_;
  std::vector<std::array<int, 3>> triangles_;
  const Project& project_;
  const EdgeLength& edge_length_;
  std::vector<std::vector<int>> around_;  // triangles of each point
  std::vector<double> wanted_;            // edge length at each point
};

}  // namespace

Surface remesh(Surface surface, const Project& project, const EdgeLength& edge_length, int rounds) {
  Remesher remesher(std::move(surface), project, edge_length);
  for (int k = 0; k < rounds; ++k) remesher.round();
  for (int k = 0; k < 4; ++k) remesher.polish();
  return remesher.take();
}

}  // namespace bodyopt
