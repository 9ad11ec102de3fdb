#include "trainer/proxy/skin_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "geometry/nearest_skin.h"
#include "geometry/table_rows.h"
#include "geometry/vertex_normals.h"
#include "runtime/cpu/kernels.h"
#include "runtime/host/carry_skin.h"

namespace bodyopt {
namespace {

std::vector<float> in_output_order(const MeshTable& mesh, std::span<const float> values) {
  std::vector<float> result;
  for (const std::uint32_t v : mesh.output_vertex) {
    result.insert(result.end(), values.begin() + 3 * std::ptrdiff_t{v}, values.begin() + 3 * std::ptrdiff_t{v} + 3);
  }
  return result;
}

// On a triangle, without its offset.
CarriedPoint point_on(const SkinPoint& nearest) {
  CarriedPoint point;
  point.triangle = static_cast<std::uint32_t>(nearest.triangle);
  point.b = static_cast<std::uint8_t>(std::lround(255 * nearest.weights[1]));
  point.c = static_cast<std::uint8_t>(std::min(std::lround(255 * nearest.weights[2]), 255L - point.b));
  return point;
}

// Along the normal, along the edge, across; metres.
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

}  // namespace

ShownSkin show_skin(const MeshTable& mesh, std::span<const float> vertices) {
  std::vector<float> normals(vertices.size());
  cpu::output_normals(mesh, vertices, normals);
  return {in_output_order(mesh, vertices), in_output_order(mesh, normals)};
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

}  // namespace bodyopt
