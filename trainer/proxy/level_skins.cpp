#include "trainer/proxy/level_skins.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>

#include "base/parallel.h"
#include "base/spread_evenly.h"
#include "base/wording.h"
#include "geometry/mesh.h"
#include "geometry/nearest_skin.h"
#include "geometry/quadric.h"
#include "runtime/basis/output_order.h"
#include "runtime/core/error.h"
#include "runtime/core/text.h"
#include "runtime/core/transformed.h"
#include "runtime/cpu/kernels.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/carry_skin.h"
#include "runtime/host/device_choice.h"
#include "runtime/threads/tbb_executor.h"
#include "trainer/train/data/unposed_shapes.h"

namespace bodyopt::trainer {
namespace {

using Corners = std::array<std::uint32_t, 3>;
using Vertices = std::vector<std::uint32_t>;

// This share of a collapsed edge's squared length, times a third of the area it drags along, counts as harm. So short
// edges go first where the skin is flat, and triangles stay well shaped.
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

// The point on its triangle, without an offset.
CarriedPoint point_on(const SkinPoint& nearest) {
  CarriedPoint point;
  point.triangle = static_cast<std::uint32_t>(nearest.triangle);
  point.b = static_cast<std::uint8_t>(std::lround(255 * nearest.weights[1]));
  point.c = static_cast<std::uint8_t>(std::min(std::lround(255 * nearest.weights[2]), 255L - point.b));
  return point;
}

// The offset along the normal, along the edge and across; metres.
Eigen::Vector3d offset_from(const CarriedPoint& point, const Eigen::Vector3d& place, const MeshTable& mesh,
                            const ShownSkin& rest) {
  const CarryFrame frame = carry_frame(mesh, rest.positions, rest.normals, point);
  const auto vector = [](const float* v) { return Eigen::Vector3f(v).cast<double>().eval(); };
  const Eigen::Vector3d offset = place - vector(frame.position);
  return {offset.dot(vector(frame.normal)), offset.dot(vector(frame.edge)), offset.dot(vector(frame.across))};
}

// Gives the points their offsets (3 x P), in steps as fine as the largest allows.
CarriedSkin in_steps(std::vector<CarriedPoint> points, const Eigen::Matrix3Xd& offsets) {
  const double largest = points.empty() ? 0 : offsets.cwiseAbs().maxCoeff();
  CarriedSkin carried{std::move(points), static_cast<float>(largest / std::numeric_limits<std::int16_t>::max())};
  if (carried.step == 0) return carried;
  const double step = static_cast<double>(carried.step);
  const auto steps = [&](double metres) {
    // The step is rounded, too.
    return static_cast<std::int16_t>(std::clamp(std::lround(metres / step), -32767L, 32767L));
  };
  for (std::size_t p = 0; p < carried.size(); ++p) {
    const Eigen::Vector3d offset = offsets.col(static_cast<Eigen::Index>(p));
    CarriedPoint& point = carried.points[p];
    point.along_normal = steps(offset[0]);
    point.along_edge = steps(offset[1]);
    point.across = steps(offset[2]);
  }
  return carried;
}

constexpr double kFinestError =
    1.0 / 500;  // of the longest extent: with its map a human keeps within 15 % of the bytes
constexpr std::size_t kDefaultLevels = 3;
constexpr std::size_t kShapesOfSkin = 16;  // more give the same skins
constexpr std::size_t kFewestVertices = 100;

std::string millimetres(double metres) { return formatted("%.4g mm", 1e3 * metres); }

// Why so many vertices are no level after one of `before`; empty: they are.
std::string objection(std::size_t vertices, std::size_t before, double error) {
  const std::string what =
      "an error of " + millimetres(error) + " leaves " + std::to_string(vertices) + " vertices of the skin, ";
  if (vertices < kFewestVertices) {
    return what + "expected " + std::to_string(kFewestVertices) +
           " at least: the error is too large for this character";
  }
  if (vertices >= before) {
    return what + "no fewer than the " + std::to_string(before) +
           " before: levels need errors that differ more, or larger ones";
  }
  return "";
}

}  // namespace

SimplifiedSkin simplify_skin(const Character& character, const std::vector<Positions>& shapes, double error) {
  return Simplifier(character, shapes, error).run();
}

ShownSkin show_skin(const MeshTable& mesh, std::span<const float> vertices) {
  std::vector<float> normals(vertices.size());
  cpu::output_normals(mesh, vertices, normals);
  return {output_of(mesh, vertices), output_of(mesh, normals)};
}

CarriedSkin map_skin(const Character& full, const MeshTable& mesh) {
  const ShownSkin rest = show_skin(mesh, mesh.rest);
  const Positions vertices = rows_of(rest.positions), normals = vertex_normals(full.vertices, full.triangles);
  const Triangles triangles = rows_of(mesh.output_triangles);
  const NearestSkin nearest(vertices, triangles);
  std::vector<CarriedPoint> welded(static_cast<std::size_t>(full.vertices.rows()));
  Eigen::Matrix3Xd offsets(3, full.vertices.rows());
  parallel_for(welded.size(), [&](std::size_t v) {
    const auto row = static_cast<Eigen::Index>(v);
    const Eigen::Vector3d place = full.vertices.row(row);
    SkinPoint on_skin = nearest.facing(place, normals.row(row));
    if (on_skin.triangle < 0) on_skin = nearest(place);
    welded[v] = point_on(on_skin);
    offsets.col(row) = offset_from(welded[v], place, mesh, rest);
  });
  const CarriedSkin carried = in_steps(std::move(welded), offsets);
  CarriedSkin output{{}, carried.step};
  for (const std::uint32_t v : full.output_vertex) output.points.push_back(carried.points[v]);
  return output;
}

SkinDistance skin_distance(const Character& full, const Character& proxy) {
  const NearestSkin nearest(proxy.vertices, proxy.triangles);
  Eigen::VectorXd distances(full.vertices.rows());
  parallel_for(static_cast<std::size_t>(distances.size()), [&](std::size_t v) {
    const Eigen::Vector3d place = full.vertices.row(static_cast<Eigen::Index>(v));
    distances[static_cast<Eigen::Index>(v)] = (nearest(place).position - place).norm();
  });
  const double count = static_cast<double>(distances.size());
  return {1e3 * std::sqrt(distances.squaredNorm() / count), 1e3 * distances.maxCoeff()};
}

std::vector<double> default_errors(const Character& character) {
  std::vector<double> errors = {kFinestError * longest_extent(character.vertices)};
  while (errors.size() < kDefaultLevels) errors.push_back(2 * errors.back());
  return errors;
}

std::vector<Positions> shapes_of_skin(const SampleSet& set) {
  std::vector<Positions> shapes = {set.character.vertices};
  for (const Sample& sample : some_samples(set.train, kShapesOfSkin)) shapes.push_back(sample.shape.read());
  return shapes;
}

std::vector<LevelSkin> level_skins(const Character& character, const std::vector<Positions>& shapes,
                                   const std::vector<double>& asked, std::vector<std::string>& notes) {
  std::vector<LevelSkin> skins;
  std::string problems;
  ErrorCause cause = ErrorCause::other;
  for (const double error : asked.empty() ? default_errors(character) : asked) {
    SimplifiedSkin skin = simplify_skin(character, shapes, error);
    const std::size_t before =
        skins.empty() ? static_cast<std::size_t>(character.vertices.rows()) : skins.back().skin.vertices.size();
    const std::string problem = objection(skin.vertices.size(), before, error);
    if (problem.empty()) {
      skins.push_back({error, std::move(skin)});
    } else if (!asked.empty()) {
      throw Error(ErrorKind::usage, problem);
    } else {
      problems += (problems.empty() ? "" : "; ") + problem;
      if (skin.vertices.size() >= kFewestVertices) continue;
      cause = ErrorCause::too_few_vertices;
      break;  // larger errors leave fewer yet
    }
  }
  if (skins.empty()) throw Error(ErrorKind::usage, problems, cause);
  if (!problems.empty()) {
    const std::string verb = skins.size() == 1 ? "there is only " : "there are only ";
    notes.push_back(verb + count_of(skins.size(), "level", "levels") + ": " + problems);
  }
  return skins;
}

double carried_rms_mm(const Level& level, const Character& full, const std::vector<Sample>& samples,
                      const std::vector<Sample>& proxy) {
  const MeshTable& mesh = level.basis.mesh;
  std::vector<double> sums(samples.size());
  parallel_for(samples.size(), [&](std::size_t n) {
    const std::vector<float> vertices = vertices_of(mesh, floats_of(proxy[n].shape.read()));
    const ShownSkin skin = show_skin(mesh, vertices);
    const std::vector<float> carried = carry_skin(mesh, level.carried, skin.positions, skin.normals);
    sums[n] = (welded_from_output(full, carried.data()) - samples[n].shape.read()).squaredNorm();
  });
  const double count = static_cast<double>(samples.size()) * static_cast<double>(full.vertices.rows());
  return 1e3 * std::sqrt(std::accumulate(sums.begin(), sums.end(), 0.0) / count);
}

ErrorStatistics level_errors(const Level& level, const Character& full, const std::vector<Sample>& samples) {
  Deformer deformer(level.basis, {.name = "cpu"});
  const std::unique_ptr<Executor> threads = make_tbb_executor();
  ErrorAccumulator errors(static_cast<std::uint32_t>(full.vertices.rows()));
  for (const Sample& sample : samples) {
    const Evaluation frame = deformer.evaluate({&sample.pose, 1});
    const std::vector<float> carried =
        carry_skin(level.basis.mesh, level.carried, frame.positions, frame.normals, *threads);
    errors.add(sample.frame, floats_of(welded_from_output(full, carried.data())), floats_of(sample.shape.read()));
  }
  return errors.finish();
}

std::vector<Sample> some_samples(const std::vector<Sample>& samples, std::size_t most) {
  return transformed(spread_evenly(samples.size(), most), [&](const std::size_t k) { return samples[k]; });
}

}  // namespace bodyopt::trainer
