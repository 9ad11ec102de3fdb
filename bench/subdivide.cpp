#include "bench/subdivide.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <queue>

namespace bodyopt::bench {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;  // lower vertex first
using Triangle = std::array<std::uint32_t, 3>;

std::vector<JointWeight> mean_weights(const std::vector<JointWeight>& a, const std::vector<JointWeight>& b) {
  std::map<std::uint32_t, double> sums;
  for (const auto* weights : {&a, &b}) {
    for (const JointWeight& w : *weights) sums[w.joint] += 0.5 * w.weight;
  }
  std::vector<JointWeight> mean;
  for (const auto& [joint, weight] : sums) mean.push_back({joint, weight});
  std::ranges::sort(mean, [](const auto& x, const auto& y) { return x.weight > y.weight; });
  return mean;
}

// The coarse character with the middles of these edges and these triangles.
Subdivision subdivision_of(const Character& coarse, const std::vector<Edge>& parents,
                           const std::vector<Triangle>& triangles) {
  Subdivision result{coarse, parents};
  Character& fine = result.character;
  fine.vertices = with_middles(coarse.vertices, result);
  for (const auto& [a, b] : parents) fine.weights.push_back(mean_weights(fine.weights[a], fine.weights[b]));
  fine.triangles = Eigen::Map<const Triangles>(triangles[0].data(), static_cast<Eigen::Index>(triangles.size()), 3);
  fine.output_triangles = fine.triangles;
  fine.output_vertex.resize(fine.weights.size());
  std::iota(fine.output_vertex.begin(), fine.output_vertex.end(), 0u);
  return result;
}

std::vector<Triangle> triangles_of(const Character& character) {
  std::vector<Triangle> triangles;
  for (Eigen::Index t = 0; t < character.triangles.rows(); ++t) {
    triangles.push_back({character.triangles(t, 0), character.triangles(t, 1), character.triangles(t, 2)});
  }
  return triangles;
}

// Halves edges, the longest first.
class EdgeHalver {
 public:
  explicit EdgeHalver(const Character& coarse) : triangles_(triangles_of(coarse)) {
    for (Eigen::Index v = 0; v < coarse.vertices.rows(); ++v) vertices_.push_back(coarse.vertices.row(v));
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) join(triangles_[t][k], triangles_[t][(k + 1) % 3], t);
    }
  }

  void halve_longest() {
    const Edge edge = by_length_.top().second;
    by_length_.pop();
    const auto [a, b] = edge;
    const auto middle = static_cast<std::uint32_t>(vertices_.size());
    vertices_.push_back(0.5 * (vertices_[a] + vertices_[b]));
    parents_.push_back(edge);
    const std::vector<std::uint32_t> beside = std::move(beside_.extract(edge).mapped());
    for (const std::uint32_t t : beside) cut(t, a, b, middle);
  }

  const std::vector<Edge>& parents() const { return parents_; }
  const std::vector<Triangle>& triangles() const { return triangles_; }

 private:
  // Notes that a triangle lies beside an edge.
  void join(std::uint32_t a, std::uint32_t b, std::uint32_t triangle) {
    const Edge edge = std::minmax(a, b);
    const auto [at, is_new] = beside_.try_emplace(edge);
    at->second.push_back(triangle);
    if (is_new) by_length_.push({(vertices_[a] - vertices_[b]).norm(), edge});
  }

  // Cuts from the middle of a and b to the corner opposite: the triangle keeps a, a new one gets b.
  void cut(std::uint32_t triangle, std::uint32_t a, std::uint32_t b, std::uint32_t middle) {
    const auto added = static_cast<std::uint32_t>(triangles_.size());
    Triangle other = triangles_[triangle];
    const std::uint32_t corner = *std::ranges::find_if(other, [&](std::uint32_t v) { return v != a && v != b; });
    std::replace(other.begin(), other.end(), a, middle);
    std::replace(triangles_[triangle].begin(), triangles_[triangle].end(), b, middle);
    triangles_.push_back(other);
    auto& across = beside_.at(std::minmax(b, corner));
    std::replace(across.begin(), across.end(), triangle, added);
    join(a, middle, triangle);
    join(middle, b, added);
    join(middle, corner, triangle);
    join(middle, corner, added);
  }

  std::vector<Eigen::RowVector3d> vertices_;
  std::vector<Triangle> triangles_;
  std::vector<Edge> parents_;
  std::map<Edge, std::vector<std::uint32_t>> beside_;  // triangles of each edge
  std::priority_queue<std::pair<double, Edge>> by_length_;
};

}  // namespace

Subdivision halve_longest_edges(const Character& coarse, std::size_t vertices) {
  EdgeHalver halver(coarse);
  const auto count = static_cast<std::size_t>(coarse.vertices.rows());
  while (count + halver.parents().size() < vertices) halver.halve_longest();
  return subdivision_of(coarse, halver.parents(), halver.triangles());
}

Subdivision halve_all_edges(const Character& coarse) {
  std::map<Edge, std::uint32_t> middles;
  std::vector<Edge> parents;
  const auto count = static_cast<std::uint32_t>(coarse.vertices.rows());
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const Edge edge = std::minmax(a, b);
    const auto [at, is_new] = middles.try_emplace(edge, count + static_cast<std::uint32_t>(parents.size()));
    if (is_new) parents.push_back(edge);
    return at->second;
  };
  std::vector<Triangle> triangles;
  for (const auto& [a, b, c] : triangles_of(coarse)) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    triangles.insert(triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return subdivision_of(coarse, parents, triangles);
}

Positions with_middles(const Positions& coarse, const Subdivision& subdivision) {
  Positions fine = coarse;
  Eigen::Index next = coarse.rows();
  fine.conservativeResize(next + static_cast<Eigen::Index>(subdivision.parents.size()), 3);
  for (const auto& [a, b] : subdivision.parents) fine.row(next++) = 0.5 * (fine.row(a) + fine.row(b));
  return fine;
}

}  // namespace bodyopt::bench
