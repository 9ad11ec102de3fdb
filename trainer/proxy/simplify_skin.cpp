#include "trainer/proxy/simplify_skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <iterator>
#include <queue>
#include <tuple>

#include "geometry/quadric.h"

namespace bodyopt {
namespace {

using Corners = std::array<std::uint32_t, 3>;
using Vertices = std::vector<std::uint32_t>;

// Of the squared length of a collapsed edge, over a third of the area it drags along: where the skin is flat, short
// edges go first and triangles stay well shaped.
constexpr double kShapeWeight = 1e-3;
constexpr double kLeastTurn = 0.25;  // cosine between a triangle's normals before and after, at rest
constexpr std::uint32_t kFewestOfJoint = 3;

Eigen::Vector3d area_vector(const Positions& points, const Corners& corners) {
  const Eigen::Vector3d a = points.row(corners[0]), b = points.row(corners[1]), c = points.row(corners[2]);
  return (b - a).cross(c - a) / 2;
}

// Moving `from` to where `to` is.
struct Collapse {
  double harm;
  std::uint32_t from, to;
  std::uint32_t from_age, to_age;  // it is out of date once one of them has changed

  bool operator<(const Collapse& other) const {  // the least harm on top
    return std::tie(harm, from, to) > std::tie(other.harm, other.from, other.to);
  }
};

class Simplifier {
 public:
  Simplifier(const Character& character, const std::vector<Positions>& shapes, double error)
      : shapes_(shapes), error2_(error * error) {
    const auto count = static_cast<std::size_t>(character.vertices.rows());
    around_.resize(count);
    age_.resize(count);
    weight_.resize(count);
    quadrics_.assign(count, std::vector<Quadric>(shapes.size()));
    for (Eigen::Index t = 0; t < character.triangles.rows(); ++t) add_triangle(character.triangles.row(t));
    of_joint_.resize(character.skeleton.size());
    for (const std::vector<JointWeight>& weights : character.weights) {
      joint_.push_back(weights.front().joint);
      ++of_joint_[joint_.back()];
    }
    for (std::uint32_t v = 0; v < count; ++v) fixed_.push_back(is_irregular(v));
    for (std::uint32_t v = 0; v < count; ++v) {
      for (const std::uint32_t other : neighbours(v)) offer(v, other);
    }
  }

  SimplifiedSkin run() {
    while (!queue_.empty()) {
      const Collapse best = queue_.top();
      queue_.pop();
      if (age_[best.from] == best.from_age && age_[best.to] == best.to_age && is_sound(best.from, best.to)) {
        collapse(best.from, best.to);
      }
    }
    return result();
  }

 private:
  void add_triangle(const Eigen::Matrix<std::uint32_t, 1, 3>& corners) {
    const auto number = static_cast<std::uint32_t>(triangles_.size());
    triangles_.push_back({corners[0], corners[1], corners[2]});
    for (const std::uint32_t v : triangles_.back()) around_[v].push_back(number);
    for (std::size_t s = 0; s < shapes_.size(); ++s) {
      const Eigen::Vector3d vector = area_vector(shapes_[s], triangles_.back());
      const double area = vector.norm(), share = area / static_cast<double>(shapes_.size());
      if (!(area > 0)) continue;
      const Eigen::Vector3d normal = vector / area;
      const double offset = -normal.dot(shapes_[s].row(corners[0]).transpose());
      for (const std::uint32_t v : triangles_.back()) {
        quadrics_[v][s].add_plane(normal, offset, share);
        weight_[v] += share;
      }
    }
  }

  // Ascending.
  Vertices neighbours(std::uint32_t v) const {
    Vertices list;
    for (const std::uint32_t t : around_[v]) {
      for (const std::uint32_t other : triangles_[t]) {
        if (other != v) list.push_back(other);
      }
    }
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    return list;
  }

  // Is any edge at it not one of two triangles that run through it in opposite directions?
  bool is_irregular(std::uint32_t v) const {
    Vertices leaving, arriving;
    for (const std::uint32_t t : around_[v]) {
      const Corners& c = triangles_[t];
      const auto k = static_cast<std::size_t>(std::find(c.begin(), c.end(), v) - c.begin());
      leaving.push_back(c[(k + 1) % 3]);
      arriving.push_back(c[(k + 2) % 3]);
    }
    std::sort(leaving.begin(), leaving.end());
    std::sort(arriving.begin(), arriving.end());
    return leaving != arriving || std::adjacent_find(leaving.begin(), leaving.end()) != leaving.end();
  }

  void offer(std::uint32_t from, std::uint32_t to) {
    if (fixed_[from]) return;
    double error = 0, area = 0;
    for (std::size_t s = 0; s < shapes_.size(); ++s) {
      const Eigen::Vector3d x = shapes_[s].row(to);
      error += quadrics_[from][s].at(x) + quadrics_[to][s].at(x);
    }
    if (error > error2_ * (weight_[from] + weight_[to])) return;
    for (const std::uint32_t t : around_[from]) area += area_vector(shapes_[0], triangles_[t]).norm();
    const double length2 = (shapes_[0].row(from) - shapes_[0].row(to)).squaredNorm();
    queue_.push({error + kShapeWeight * length2 * area / 3, from, to, age_[from], age_[to]});
  }

  bool is_sound(std::uint32_t from, std::uint32_t to) const {
    return of_joint_[joint_[from]] > kFewestOfJoint && keeps_topology(from, to) && keeps_sides(from, to);
  }

  // The link condition (Dey, Edelsbrunner, Guha and Nekhayev 1999): both ends share the two vertices opposite their
  // edge and no others. None of those may be left with two triangles.
  bool keeps_topology(std::uint32_t from, std::uint32_t to) const {
    const Vertices a = neighbours(from), b = neighbours(to);
    Vertices shared;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(shared));
    return shared.size() == 2 && a.size() + b.size() > 6 &&
           std::none_of(shared.begin(), shared.end(), [&](std::uint32_t v) { return around_[v].size() <= 3; });
  }

  // No triangle turns over at rest, or nearly so.
  bool keeps_sides(std::uint32_t from, std::uint32_t to) const {
    for (const std::uint32_t t : around_[from]) {
      Corners corners = triangles_[t];
      if (std::find(corners.begin(), corners.end(), to) != corners.end()) continue;
      const Eigen::Vector3d before = area_vector(shapes_[0], corners);
      std::replace(corners.begin(), corners.end(), from, to);
      const Eigen::Vector3d after = area_vector(shapes_[0], corners);
      if (!(before.dot(after) > kLeastTurn * before.norm() * after.norm())) return false;
    }
    return true;
  }

  void collapse(std::uint32_t from, std::uint32_t to) {
    for (const std::uint32_t t : around_[from]) {
      Corners& corners = triangles_[t];
      if (std::find(corners.begin(), corners.end(), to) != corners.end()) {
        for (const std::uint32_t v : corners) {
          if (v != from) std::erase(around_[v], t);
        }
      } else {
        std::replace(corners.begin(), corners.end(), from, to);
        around_[to].push_back(t);
      }
    }
    around_[from].clear();
    --of_joint_[joint_[from]];
    for (std::size_t s = 0; s < shapes_.size(); ++s) quadrics_[to][s] += quadrics_[from][s];
    quadrics_[from] = {};
    weight_[to] += weight_[from];
    ++age_[from];
    ++age_[to];
    for (const std::uint32_t other : neighbours(to)) {
      offer(to, other);
      offer(other, to);
    }
  }

  SimplifiedSkin result() const {
    SimplifiedSkin skin;
    std::vector<std::uint32_t> number(around_.size());
    for (std::uint32_t v = 0; v < around_.size(); ++v) {
      if (around_[v].empty()) continue;
      number[v] = static_cast<std::uint32_t>(skin.vertices.size());
      skin.vertices.push_back(v);
    }
    std::vector<std::uint32_t> corners;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      const Corners& c = triangles_[t];
      if (std::find(around_[c[0]].begin(), around_[c[0]].end(), t) == around_[c[0]].end()) continue;
      for (const std::uint32_t v : c) corners.push_back(number[v]);
    }
    skin.triangles = Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
    return skin;
  }

  const std::vector<Positions>& shapes_;
  double error2_;
  std::vector<Corners> triangles_;
  std::vector<Vertices> around_;  // triangles of each vertex; none once it is gone
  std::vector<std::uint32_t> age_;
  std::vector<double> weight_;                  // area of a vertex' planes, square metres, the mean over shapes
  std::vector<std::vector<Quadric>> quadrics_;  // of a vertex in each shape; none once it is gone
  std::vector<bool> fixed_;
  std::vector<std::uint32_t> joint_, of_joint_;  // that a vertex follows most; how many follow each
  std::priority_queue<Collapse> queue_;
};

}  // namespace

SimplifiedSkin simplify_skin(const Character& character, const std::vector<Positions>& shapes, double error) {
  return Simplifier(character, shapes, error).run();
}

}  // namespace bodyopt
