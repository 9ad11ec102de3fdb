#include "trainer/anatomy/section.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "geometry/nearest_skin.h"

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

// Where a row of pixels enters (1) or leaves (-1) the skin.
struct Crossing {
  double at;  // pixels from the left
  int turn;
};

// Of a triangle's corners above and below a plane: where its edges pass through, in pixels from the corner.
std::vector<Eigen::Vector2d> cut_triangle(const SectionPlane& plane, const std::array<Eigen::Vector3d, 3>& corners) {
  const Eigen::Vector3d normal = plane.right.cross(plane.down);
  std::vector<Eigen::Vector2d> ends;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d a = corners[k] - plane.corner, b = corners[(k + 1) % 3] - plane.corner;
    const double above = normal.dot(a), below = normal.dot(b);
    if ((above > 0) == (below > 0)) continue;
    const Eigen::Vector3d at = (a + above / (above - below) * (b - a)) / plane.pixel;
    ends.emplace_back(plane.right.dot(at), plane.down.dot(at));
  }
  return ends;
}

std::vector<std::vector<Crossing>> crossings_of_rows(const SectionPlane& plane, const Positions& skin,
                                                     const Triangles& triangles) {
  std::vector<std::vector<Crossing>> rows(static_cast<std::size_t>(plane.height));
  for (const auto& triangle : triangles.rowwise()) {
    std::array<Eigen::Vector3d, 3> corners;
    for (int k = 0; k < 3; ++k) corners[static_cast<std::size_t>(k)] = skin.row(triangle[k]);
    const std::vector<Eigen::Vector2d> ends = cut_triangle(plane, corners);
    if (ends.size() != 2) continue;
    const Eigen::Vector3d outward = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    const int turn = plane.right.dot(outward) < 0 ? 1 : -1;
    const auto [upper, lower] =
        std::minmax(ends[0], ends[1], [](const auto& a, const auto& b) { return a.y() < b.y(); });
    const double last = std::min(std::ceil(lower.y() - 0.5), double(plane.height));
    for (double row = std::max(0.0, std::ceil(upper.y() - 0.5)); row < last; ++row) {
      const double share = (row + 0.5 - upper.y()) / (lower.y() - upper.y());
      rows[static_cast<std::size_t>(row)].push_back({std::lerp(upper.x(), lower.x(), share), turn});
    }
  }
  for (std::vector<Crossing>& row : rows) {
    std::ranges::stable_sort(row, {}, &Crossing::at);
  }
  return rows;
}

Eigen::Affine3d affine(const Affine& transform) {
  Eigen::Affine3d result = Eigen::Affine3d::Identity();
  result.affine() = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(&transform.m[0][0]);
  return result;
}

class BackToRest {
 public:
  explicit BackToRest(const PosedBody& body) : body_(body), nearest_(body.skin, body.character.triangles) {
    for (const Affine& joint : body.skinning) skinning_.push_back(affine(joint));
  }

  // Nothing where the joints blend to no space at all.
  std::optional<RestPoint> operator()(const Eigen::Vector3d& point) const {
    constexpr double kFade = 8;  // times what the skin is off by: so slowly that nothing folds over
    const SkinPoint skin = nearest_(point);
    Eigen::Matrix4d blend = Eigen::Matrix4d::Zero();
    Eigen::Vector3d at_rest = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const double share = skin.weights[static_cast<Eigen::Index>(k)];
      at_rest += share * body_.character.vertices.row(skin.vertices[k]).transpose();
      for (const JointWeight& of : body_.character.weights[skin.vertices[k]]) {
        blend += share * of.weight * skinning_[of.joint].matrix();
      }
    }
    const Eigen::Affine3d back(Eigen::Affine3d(blend).inverse());
    if (!back.matrix().allFinite()) return std::nullopt;
    const Eigen::Vector3d off = at_rest - back * skin.position;
    const double depth = (point - skin.position).norm(), reach = kFade * off.norm();
    const double share = depth < reach ? 1 - depth / reach : 0;
    return RestPoint{back * point + share * off};
  }

 private:
  const PosedBody& body_;
  NearestSkin nearest_;
  std::vector<Eigen::Affine3d> skinning_;
};

// Row by row, on several threads.
void for_each_pixel(const SectionPlane& plane, const std::function<void(std::size_t pixel)>& body) {
  const auto width = static_cast<std::size_t>(plane.width);
  parallel_for(static_cast<std::size_t>(plane.height), [&](std::size_t y) {
    for (std::size_t pixel = y * width; pixel < (y + 1) * width; ++pixel) body(pixel);
  });
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

std::vector<bool> pixels_inside(const SectionPlane& plane, const Positions& skin, const Triangles& triangles) {
  std::vector<bool> inside(static_cast<std::size_t>(plane.size()));
  const std::vector<std::vector<Crossing>> rows = crossings_of_rows(plane, skin, triangles);
  for (std::size_t y = 0; y < rows.size(); ++y) {
    auto next = rows[y].begin();
    int winding = 0;
    for (int x = 0; x < plane.width; ++x) {
      for (; next != rows[y].end() && next->at < x + 0.5; ++next) winding += next->turn;
      inside[y * static_cast<std::size_t>(plane.width) + static_cast<std::size_t>(x)] = winding != 0;
    }
  }
  return inside;
}

RestPoints rest_points(const SectionPlane& plane, const Positions& skin, const Triangles& triangles) {
  const std::vector<bool> inside = pixels_inside(plane, skin, triangles);
  RestPoints points(inside.size());
  for (std::size_t pixel = 0; pixel < inside.size(); ++pixel) {
    if (inside[pixel]) points[pixel] = RestPoint{plane.middle(static_cast<int>(pixel))};
  }
  return points;
}

SectionPlane moved_plane(const SectionPlane& plane, const Affine& joint) {
  const Eigen::Affine3d move = affine(joint);
  SectionPlane moved = plane;
  moved.corner = move * plane.corner;
  moved.right = (move.linear() * plane.right).normalized();
  const Eigen::Vector3d down = move.linear() * plane.down;
  moved.down = (down - down.dot(moved.right) * moved.right).normalized();
  return moved;
}

RestPoints rest_points(const SectionPlane& plane, const PosedBody& body) {
  RestPoints points(static_cast<std::size_t>(plane.size()));
  const std::vector<bool> inside = pixels_inside(plane, body.skin, body.character.triangles);
  const BackToRest back(body);
  for_each_pixel(plane, [&](std::size_t pixel) {
    if (inside[pixel]) points[pixel] = back(plane.middle(static_cast<int>(pixel)));
  });
  return points;
}

TissueSection section_of(const SectionPlane& plane, const RestPoints& rest,
                         const std::function<TissueAt(const Eigen::Vector3d&)>& tissue_at) {
  TissueSection section{plane.width, plane.height, std::vector<TissueAt>(rest.size())};
  for_each_pixel(plane, [&](std::size_t pixel) {
    if (!rest[pixel]) return;
    TissueAt& tissue = section.tissue[pixel] = tissue_at(rest[pixel]->position);
    if (tissue.kind == TissueKind::outside) tissue.kind = TissueKind::fat;
  });
  return section;
}

}  // namespace bodyopt
