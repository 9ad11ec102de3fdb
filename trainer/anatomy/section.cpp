#include "trainer/anatomy/section.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace bodyopt {
namespace {

// Pixels of a plane that a box around some points covers, first and last.
struct PixelRange {
  int left, right, top, bottom;
};

PixelRange pixels_under(const SectionPlane& plane, const std::vector<Eigen::Vector3d>& points) {
  Eigen::Array2d low = Eigen::Array2d::Constant(1e30), high = -low;
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3d from_corner = point - plane.corner;
    const Eigen::Array2d at(from_corner.dot(plane.right) / plane.pixel, from_corner.dot(plane.down) / plane.pixel);
    low = low.min(at);
    high = high.max(at);
  }
  const auto pixel = [](double at, int count) { return static_cast<int>(std::clamp(at, -1.0, double(count))); };
  return {std::max(0, pixel(std::floor(low[0]), plane.width)), std::min(plane.width - 1, pixel(high[0], plane.width)),
          std::max(0, pixel(std::floor(low[1]), plane.height)),
          std::min(plane.height - 1, pixel(high[1], plane.height))};
}

// Where the plane cuts the edges of a tet.
std::vector<Eigen::Vector3d> cut_edges(const std::array<Eigen::Vector3d, 4>& corners,
                                       const std::array<double, 4>& heights) {
  std::vector<Eigen::Vector3d> points;
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = a + 1; b < 4; ++b) {
      if ((heights[a] <= 0) == (heights[b] <= 0)) continue;
      points.push_back(corners[a] + heights[a] / (heights[a] - heights[b]) * (corners[b] - corners[a]));
    }
  }
  return points;
}

// A moved tet that the plane cuts.
struct CutTet {
  PixelRange range;              // around it
  Eigen::Vector3d corner, rest;  // its first, moved and at rest
  Eigen::Matrix3d weights;       // of a point from that corner: barycentric, of the other three
  Eigen::Matrix3d rest_edges;

  // Nothing outside of it.
  std::optional<Eigen::Vector3d> at_rest(const Eigen::Vector3d& point) const {
    constexpr double kRounding = 1e-9;
    const Eigen::Vector3d of_corners = weights * (point - corner);
    if (of_corners.minCoeff() < -kRounding || of_corners.sum() > 1 + kRounding) return std::nullopt;
    return rest + rest_edges * of_corners;
  }
};

// Nothing where the plane misses it, or it is flat and covers no pixel.
std::optional<CutTet> cut_tet(const SectionPlane& plane, const TetMesh& rest, const Positions& moved,
                              Eigen::Index tet) {
  const Eigen::Vector3d normal = plane.right.cross(plane.down);
  std::array<Eigen::Vector3d, 4> corners;
  std::array<double, 4> heights;
  Eigen::Matrix3d edges;
  for (int k = 0; k < 4; ++k) {
    const auto at = static_cast<std::size_t>(k);
    corners[at] = moved.row(rest.tets(tet, k));
    heights[at] = normal.dot(corners[at] - plane.corner);
    if (k > 0) edges.col(k - 1) = corners[at] - corners[0];
  }
  const std::vector<Eigen::Vector3d> cut = cut_edges(corners, heights);
  const Eigen::Matrix3d weights = edges.inverse();
  if (cut.empty() || !weights.allFinite()) return std::nullopt;
  return CutTet{pixels_under(plane, cut), corners[0], rest.nodes.row(rest.tets(tet, 0)), weights, tet_edges(rest, tet)};
}

}  // namespace

Eigen::Vector3d SectionPlane::middle(int pixel_number) const {
  return corner + (pixel_number % width + 0.5) * pixel * right + (pixel_number / width + 0.5) * pixel * down;
}

SectionPlane plane_around(const Eigen::Vector3d& middle, const Eigen::Vector3d& right, const Eigen::Vector3d& down,
                          const std::array<double, 2>& sides, double pixel) {
  SectionPlane plane{middle, right, down, pixel, 0, 0};
  plane.width = std::max(1, static_cast<int>(std::ceil(sides[0] / pixel)));
  plane.height = std::max(1, static_cast<int>(std::ceil(sides[1] / pixel)));
  plane.corner = middle - 0.5 * plane.width * pixel * right - 0.5 * plane.height * pixel * down;
  return plane;
}

RestPoints rest_points(const SectionPlane& plane, const TetMesh& rest, const Positions& moved,
                       const std::function<bool(const Eigen::Vector3d&)>& is_tissue) {
  RestPoints points(static_cast<std::size_t>(plane.size()));
  std::vector<bool> found(points.size());  // tissue
  for (Eigen::Index t = 0; t < rest.tets.rows(); ++t) {
    const std::optional<CutTet> cut = cut_tet(plane, rest, moved, t);
    if (!cut) continue;
    for (int y = cut->range.top; y <= cut->range.bottom; ++y) {
      for (int x = cut->range.left; x <= cut->range.right; ++x) {
        const auto pixel = static_cast<std::size_t>(y * plane.width + x);
        if (found[pixel]) continue;
        const std::optional<Eigen::Vector3d> at_rest = cut->at_rest(plane.middle(static_cast<int>(pixel)));
        if (!at_rest) continue;
        found[pixel] = is_tissue(*at_rest);
        if (found[pixel] || !points[pixel]) points[pixel] = RestPoint{*at_rest, t};
      }
    }
  }
  return points;
}

TissueSection section_of(const SectionPlane& plane, const RestPoints& rest,
                         const std::function<TissueAt(const Eigen::Vector3d&)>& tissue_at) {
  TissueSection section{plane.width, plane.height, std::vector<TissueAt>(rest.size())};
  parallel_for(static_cast<std::size_t>(plane.height), [&](std::size_t y) {
    const auto width = static_cast<std::size_t>(plane.width);
    for (std::size_t pixel = y * width; pixel < (y + 1) * width; ++pixel) {
      if (!rest[pixel]) continue;
      TissueAt& tissue = section.tissue[pixel] = tissue_at(rest[pixel]->position);
      if (tissue.kind == TissueKind::outside) tissue.kind = TissueKind::fat;
    }
  });
  return section;
}

}  // namespace bodyopt
