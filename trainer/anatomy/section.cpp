#include "trainer/anatomy/section.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "geometry/nearest_skin.h"

namespace bodyopt::trainer {
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

// The points where the plane cuts the edges of a tet.
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

// A place where a row of pixels enters (1) or leaves (-1) the skin.
struct Crossing {
  double at;  // pixels from the left
  int turn;
};

// The points where a triangle's edges pass through the plane, in pixels from the corner.
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
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const CornerPoints corners = corners_of(skin, triangles, t);
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

// Half space: a point, and which way the plane through it faces.
struct Cut {
  std::string name;
  Eigen::Vector3d at, normal;
  std::vector<BodyRegion> regions;  // that the picture is of; empty: all that is cut
};

// The samples in the regions of a cut that lie next to it.
std::vector<int> samples_at(const Cut& cut, const AnatomyField::Half& half) {
  std::vector<int> samples;
  for (int s = 0; s < half.grid.size(); ++s) {
    const BodyRegion region = half.tissue.region[static_cast<std::size_t>(s)];
    if (!cut.regions.empty() && std::ranges::find(cut.regions, region) == cut.regions.end()) continue;
    const Eigen::Vector3d point = half.grid.points.row(s);
    if (std::abs(cut.normal.dot(point - cut.at)) <= half.grid.cell) samples.push_back(s);
  }
  return samples;
}

std::size_t main_joint(const AnatomyField::Half& half, const std::vector<int>& samples) {
  std::vector<double> sums(half.body.places.size());
  for (const int s : samples) {
    const SkinPoint& skin = half.grid.skin[static_cast<std::size_t>(s)];
    for (int k = 0; k < 3; ++k) {
      for (const JointWeight& of : half.body.weights[skin.vertices[static_cast<std::size_t>(k)]]) {
        sums[of.joint] += skin.weights[k] * of.weight;
      }
    }
  }
  return static_cast<std::size_t>(std::ranges::max_element(sums) - sums.begin());
}

// A plane that lies flat has the front at the top of the picture and the left side at its right, as radiologists do.
// Any other plane has its upper end at the top.
SectionPlane plane_of(const Cut& cut, const AnatomyField::Half& half, const std::vector<int>& samples, int pixels) {
  const bool is_flat = std::abs(cut.normal.y()) > 0.5;
  const Eigen::Vector3d up = is_flat ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
  const Eigen::Vector3d down = -(up - up.dot(cut.normal) * cut.normal).normalized();
  const Eigen::Vector3d right = cut.normal.cross(down);
  Eigen::AlignedBox2d box;
  for (const int s : samples) {
    const Eigen::Vector3d from_cut = half.grid.points.row(s).transpose() - cut.at;
    box.extend(Eigen::Vector2d(right.dot(from_cut), down.dot(from_cut)));
  }
  if (box.isEmpty()) box.extend(Eigen::Vector2d::Zero().eval());
  const bool goes_through_middle = cut.at.x() == 0 && half.body.has_plane && std::abs(cut.normal.x()) < 0.5;
  if (goes_through_middle) {  // the other half is its mirror image
    box.extend(Eigen::Vector2d(-box.max().x(), box.max().y()));
    box.extend(Eigen::Vector2d(-box.min().x(), box.max().y()));
  }
  const Eigen::Vector2d sides = box.sizes() + Eigen::Vector2d::Constant(4 * half.grid.cell);
  const Eigen::Vector3d middle = cut.at + box.center().x() * right + box.center().y() * down;
  const Eigen::Affine3d to_rest = half.body.from_rest.inverse();
  return plane_around(to_rest * middle, to_rest.linear() * right, to_rest.linear() * down, {sides.x(), sides.y()},
                      sides.maxCoeff() / pixels);
}

// Adds a cut across a bone, a share of the way along it; nothing where a joint has no name that is known.
void add_across(const HalfBody& body, const Cut& pattern, BodyPart from, BodyPart to, double share,
                std::vector<Cut>& cuts) {
  const int first = body.find(from), last = body.find(to);
  if (first < 0 || last < 0) return;
  const Eigen::Vector3d along =
      body.places[static_cast<std::size_t>(last)] - body.places[static_cast<std::size_t>(first)];
  if (!(along.norm() > 0)) return;
  cuts.push_back(pattern);
  cuts.back().at = body.places[static_cast<std::size_t>(first)] + share * along;
  cuts.back().normal = along.normalized();
}

std::vector<Cut> human_cuts(const HalfBody& body) {
  std::vector<Cut> cuts;
  const auto across = [&](const char* name, BodyRegion region, BodyPart from, BodyPart to, double share) {
    add_across(body, {name, {}, {}, {region}}, from, to, share, cuts);
  };
  across("thigh", BodyRegion::thigh, BodyPart::thigh, BodyPart::shin, 0.5);
  across("calf", BodyRegion::calf, BodyPart::shin, BodyPart::foot, 0.3);
  const int hip = body.find(BodyPart::thigh), shoulder = body.find(BodyPart::upper_arm);
  if (hip >= 0 && shoulder >= 0) {
    const Eigen::Vector3d low = body.places[static_cast<std::size_t>(hip)],
                          high = body.places[static_cast<std::size_t>(shoulder)];
    // Shares of the way from the hip joints to the shoulders' height.
    constexpr std::pair<const char*, double> kLevels[] = {{"hip", 0}, {"loin (L3)", 0.32}, {"chest", 0.68}};
    for (const auto& [name, share] : kLevels) {
      const Eigen::Vector3d at = low + share * (high - low);
      cuts.push_back({name, {0, at.y(), at.z()}, -Eigen::Vector3d::UnitY(), {BodyRegion::trunk, BodyRegion::hip}});
    }
    cuts[cuts.size() - 3].regions.push_back(BodyRegion::thigh);
  }
  across("upper arm", BodyRegion::upper_arm, BodyPart::upper_arm, BodyPart::forearm, 0.5);
  across("forearm", BodyRegion::forearm, BodyPart::forearm, BodyPart::hand, 0.3);
  return cuts;
}

std::vector<Cut> cuts_along(const HalfBody& body) {
  constexpr int kCuts = 5;
  Eigen::AlignedBox3d box;
  for (const auto& vertex : body.vertices.rowwise()) box.extend(vertex.transpose());
  int longest = 0;
  Eigen::Vector3d sides = box.sizes();
  if (body.has_plane) sides.x() = 0;
  sides.maxCoeff(&longest);
  Eigen::Vector3d middle = box.center();
  if (body.has_plane) middle.x() = 0;
  std::vector<Cut> cuts;
  for (int k = 0; k < kCuts; ++k) {
    const double share = (k + 0.5) / kCuts;
    Eigen::Vector3d at = middle;
    at[longest] = box.max()[longest] - share * box.sizes()[longest];
    cuts.push_back({std::to_string(std::lround(100 * share)) + " %", at, -Eigen::Vector3d::Unit(longest), {}});
  }
  const int across = longest == 0 ? 2 : 0;
  cuts.push_back({"along the middle", middle, Eigen::Vector3d::Unit(across), {}});
  return cuts;
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

std::vector<NamedPlane> telling_planes(const AnatomyField& field, int pixels) {
  const AnatomyField::Half& half = field.halves().front();
  std::vector<Cut> cuts;
  if (field.kind() == BodyKind::biped || field.kind() == BodyKind::limb) cuts = human_cuts(half.body);
  constexpr std::size_t kFewest = 3;  // fewer are of joints that are a human's by name alone, and tell little
  if (cuts.size() < kFewest) cuts = cuts_along(half.body);
  std::vector<NamedPlane> planes;
  for (const Cut& cut : cuts) {
    const std::vector<int> samples = samples_at(cut, half);
    planes.push_back({cut.name, plane_of(cut, half, samples, pixels), main_joint(half, samples)});
  }
  return planes;
}

}  // namespace bodyopt::trainer
