#include "trainer/train/features/strain.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "geometry/nearest_skin.h"
#include "geometry/table_rows.h"
#include "runtime/core/transformed.h"
#include "trainer/train/features/features.h"

namespace bodyopt {
namespace {

using Polyline = std::vector<Eigen::Vector3d>;

constexpr double kSpacing = 0.012;                         // metres between points of a fibre, at most
constexpr double kSpread = 50.0 * std::numbers::pi / 180;  // the outer fibres' angle around the belly
constexpr double kShortest = 0.005;                        // metres; a shorter fibre measures nothing

Polyline path_of(const Muscle& muscle) {
  Polyline path;
  for (const MusclePoint& point : muscle.path) {
    path.emplace_back(point.position[0], point.position[1], point.position[2]);
  }
  return path;
}

double length_of(const Polyline& line) {
  double length = 0;
  for (std::size_t k = 1; k < line.size(); ++k) length += (line[k] - line[k - 1]).norm();
  return length;
}

// `count` points at equal distances along the line, its ends included.
Polyline resample(const Polyline& line, std::size_t count) {
  Polyline result;
  const double step = length_of(line) / static_cast<double>(count - 1);
  double passed = 0;
  std::size_t segment = 1;
  for (std::size_t k = 0; k < count; ++k) {
    const double at = step * static_cast<double>(k);
    while (segment + 1 < line.size() && passed + (line[segment] - line[segment - 1]).norm() < at) {
      passed += (line[segment] - line[segment - 1]).norm();
      ++segment;
    }
    const Eigen::Vector3d along = line[segment] - line[segment - 1];
    const double t = along.norm() > 0 ? std::clamp((at - passed) / along.norm(), 0.0, 1.0) : 0;
    result.push_back(line[segment - 1] + t * along);
  }
  return result;
}

void smooth(Polyline& line) {
  const Polyline old = line;
  for (std::size_t k = 1; k + 1 < line.size(); ++k) line[k] = 0.25 * (old[k - 1] + old[k + 1]) + 0.5 * old[k];
}

// A muscle's middle line, the direction along it and the direction from it to the skin, at equal distances.
struct Belly {
  Polyline line, along, outward;
};

Belly make_belly(const Muscle& muscle, const NearestSkin& nearest) {
  const Polyline path = path_of(muscle);
  const double length = length_of(path);
  Belly belly;
  if (path.size() < 2 || !(length > kShortest)) return belly;
  const auto count = static_cast<std::size_t>(std::clamp(std::ceil(length / kSpacing), 4.0, 200.0)) + 1;
  belly.line = resample(path, count);
  smooth(belly.line);
  // One direction for the whole muscle, so that a fibre does not jump from one side of a limb to the other.
  Eigen::Vector3d side = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : belly.line) side += nearest(point).position - point;
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::Vector3d along = (belly.line[std::min(k + 1, count - 1)] - belly.line[k > 0 ? k - 1 : 0]).normalized();
    Eigen::Vector3d out = side - side.dot(along) * along;
    if (!(out.norm() > 1e-6)) out = along.unitOrthogonal();
    belly.along.push_back(along);
    belly.outward.push_back(out.normalized());
  }
  return belly;
}

// One fibre on the skin. `angle` turns around the belly, zero facing the skin.
std::vector<SkinPoint> project_fibre(const Belly& belly, double radius, double angle, const NearestSkin& nearest) {
  Polyline line;
  for (std::size_t k = 0; k < belly.line.size(); ++k) {
    const Eigen::Vector3d out = Eigen::AngleAxisd(angle, belly.along[k]) * belly.outward[k];
    line.push_back(nearest(belly.line[k] + radius * out).position);
  }
  smooth(line);
  smooth(line);
  std::vector<SkinPoint> fibre;
  for (const Eigen::Vector3d& point : line) {
    const SkinPoint on_skin = nearest(point);
    const bool apart = fibre.empty() || (on_skin.position - fibre.back().position).norm() > 0.25 * kSpacing;
    if (apart) fibre.push_back(on_skin);
  }
  return fibre;
}

double length_of(const std::vector<SkinPoint>& fibre) {
  double length = 0;
  for (std::size_t k = 1; k < fibre.size(); ++k) length += (fibre[k].position - fibre[k - 1].position).norm();
  return length;
}

class TableBuilder {
 public:
  TableBuilder() { table_.fibre_begin.push_back(0); }

  void add(const std::string& name, const std::vector<SkinPoint>& fibre) {
    for (const SkinPoint& point : fibre) {
      FibrePoint entry;
      entry.a = index_of(point.vertices[0]);
      entry.b = index_of(point.vertices[1]);
      entry.c = index_of(point.vertices[2]);
      entry.wa = static_cast<float>(point.weights[0]);
      entry.wb = static_cast<float>(point.weights[1]);
      entry.wc = static_cast<float>(point.weights[2]);
      table_.points.push_back(entry);
    }
    table_.fibre_begin.push_back(static_cast<std::uint32_t>(table_.points.size()));
    table_.rest_length.push_back(1.0f);
    table_.names.push_back(name);
  }

  StrainTable take() { return std::move(table_); }

 private:
  std::uint32_t index_of(std::uint32_t vertex) {
    const auto [place, added] = index_.emplace(vertex, static_cast<std::uint32_t>(table_.vertices.size()));
    if (added) table_.vertices.push_back(vertex);
    return place->second;
  }

  StrainTable table_;
  std::map<std::uint32_t, std::uint32_t> index_;
};

}  // namespace

StrainTable make_strain_table(const Basis& basis, const std::vector<Muscle>& muscles) {
  TableBuilder builder;
  const Positions rest = rows_of(basis.mesh.rest);
  const Triangles triangles = rows_of(basis.mesh.triangles);
  if (triangles.rows() == 0) return builder.take();
  const NearestSkin nearest(rest, triangles);
  for (const Muscle& muscle : muscles) {
    const Belly belly = make_belly(muscle, nearest);
    for (int k = 0; k < muscle.fibre_count && !belly.line.empty(); ++k) {
      const double place = muscle.fibre_count > 1 ? 2.0 * k / (muscle.fibre_count - 1) - 1 : 0;  // -1 .. 1
      const std::vector<SkinPoint> fibre = project_fibre(belly, muscle.radius, place * kSpread, nearest);
      if (length_of(fibre) > kShortest) builder.add(muscle.name + "/" + std::to_string(k + 1), fibre);
    }
  }
  StrainTable table = builder.take();
  // With a rest length of 1 m the strain is the length less one.
  for (std::size_t k = 0; const float strain : measure_strains(basis, table, bind_pose(basis.skeleton))) {
    table.rest_length[k++] = 1 + strain;
  }
  return table;
}

StrainTable keep_fibres(const StrainTable& strain, const std::vector<std::uint32_t>& kept) {
  StrainTable result;
  result.fibre_begin = {0};
  std::map<std::uint32_t, std::uint32_t> place;  // of a strain vertex in the result
  const auto moved = [&](std::uint32_t vertex) {
    const auto [entry, added] = place.emplace(vertex, static_cast<std::uint32_t>(result.vertices.size()));
    if (added) result.vertices.push_back(strain.vertices[vertex]);
    return entry->second;
  };
  for (const std::uint32_t fibre : kept) {
    for (std::uint32_t p = strain.fibre_begin[fibre]; p < strain.fibre_begin[fibre + 1]; ++p) {
      FibrePoint point = strain.points[p];
      point.a = moved(point.a);
      point.b = moved(point.b);
      point.c = moved(point.c);
      result.points.push_back(point);
    }
    result.fibre_begin.push_back(static_cast<std::uint32_t>(result.points.size()));
    result.rest_length.push_back(strain.rest_length[fibre]);
    result.names.push_back(strain.names[fibre]);
  }
  return result;
}

std::vector<std::size_t> fibre_muscles(const StrainTable& strain, const std::vector<Muscle>& muscles) {
  std::map<std::string, std::size_t> index;
  for (std::size_t m = 0; m < muscles.size(); ++m) index[muscles[m].name] = m;
  return transformed(strain.names, [&](const std::string& name) { return index.at(name.substr(0, name.rfind('/'))); });
}

}  // namespace bodyopt
