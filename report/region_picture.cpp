#include "report/region_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "draw/camera.h"
#include "draw/colours.h"
#include "geometry/mesh.h"
#include "report/pictures.h"
#include "runtime/core/transformed.h"

namespace bodyopt::report {
namespace {

// The regions with which each region shares a vertex.
std::vector<std::set<std::size_t>> neighbours_of(std::span<const DrawnRegion> regions, std::size_t vertices) {
  std::vector<std::vector<std::size_t>> regions_at(vertices);
  std::vector<std::set<std::size_t>> neighbours(regions.size());
  for (std::size_t r = 0; r < regions.size(); ++r) {
    for (const std::uint32_t v : regions[r].vertices) {
      for (const std::size_t other : regions_at[v]) {
        neighbours[r].insert(other);
        neighbours[other].insert(r);
      }
      regions_at[v].push_back(r);
    }
  }
  return neighbours;
}

// Hues all around in three lightnesses.
std::vector<draw::Oklab> palette(std::size_t count) {
  constexpr double kLightness[] = {0.80, 0.62, 0.46}, kChroma = 0.15;
  std::vector<draw::Oklab> colours;
  for (std::size_t k = 0; k < count; ++k) {
    colours.push_back(
        draw::oklab(kLightness[k % 3], kChroma, 360.0 * static_cast<double>(k) / static_cast<double>(count)));
  }
  return colours;
}

double clash(const draw::Oklab& a, const draw::Oklab& b) {
  double distance2 = 0;
  for (std::size_t i = 0; i < 3; ++i) distance2 += (a[i] - b[i]) * (a[i] - b[i]);
  return 1 / (distance2 * distance2);
}

// The skin as a camera sees it.
class RegionPanel {
 public:
  RegionPanel(std::span<const float> skin, std::span<const float> normals, std::span<const std::uint32_t> triangles,
              const draw::Camera& camera, const draw::Image& image)
      : skin_(skin),
        normals_(normals),
        camera_(camera),
        view_(draw::view_matrix(camera)),
        scale_(0.5f * static_cast<float>(image.height) / std::tan(camera.vertical_angle / 2)),
        width_(image.width),
        height_(image.height),
        depths_(std::size_t{width_} * height_, std::numeric_limits<float>::infinity()) {
    for (std::size_t v = 0; v < skin.size() / 3; ++v) points_.push_back(seen(&skin[3 * v]));
    for (std::size_t t = 0; t < triangles.size(); t += 3) cover(triangles.subspan(t, 3));
    const auto [nearest, farthest] =
        std::ranges::minmax(points_, {}, [](const std::array<float, 3>& point) { return point[2]; });
    tolerance_ = kSameDepth * (farthest[2] - nearest[2]);
  }

  // Pixels: the vertex of the region's core that is nearest to the middle of what is seen of the region. None where
  // that is little.
  std::optional<std::array<float, 2>> place_of(const DrawnRegion& region) const {
    constexpr double kLeastSeen = 0.15;  // of its weight
    double all = 0, seen = 0, x = 0, y = 0;
    for (std::size_t k = 0; k < region.vertices.size(); ++k) {
      const double weight = region.weights[k];
      all += weight;
      if (!is_seen(region.vertices[k])) continue;
      const std::array<float, 2> at = pixel(region.vertices[k]);
      seen += weight;
      x += weight * static_cast<double>(at[0]);
      y += weight * static_cast<double>(at[1]);
    }
    if (seen <= kLeastSeen * all) return {};
    std::optional<std::array<float, 2>> place;
    double nearest = std::numeric_limits<double>::infinity();
    const double core = 0.5 * *std::ranges::max_element(region.weights);
    for (std::size_t k = 0; k < region.vertices.size(); ++k) {
      if (region.weights[k] < core || !is_seen(region.vertices[k])) continue;
      const std::array<float, 2> at = pixel(region.vertices[k]);
      const double distance = std::hypot(static_cast<double>(at[0]) - x / seen, static_cast<double>(at[1]) - y / seen);
      if (distance >= nearest) continue;
      nearest = distance;
      place = at;
    }
    return place;
  }

 private:
  static constexpr float kSameDepth = 0.02f;  // of the depth of the skin: a vertex lies in its own triangles

  // Pixels to the right and down, and metres before the camera.
  std::array<float, 3> seen(const float* vertex) const {
    std::array<float, 3> at;
    for (std::size_t r = 0; r < 3; ++r) {
      at[r] = view_[r][3];
      for (std::size_t i = 0; i < 3; ++i) at[r] += view_[r][i] * vertex[i];
    }
    const float scale = scale_ / -at[2];
    return {0.5f * static_cast<float>(width_) + scale * at[0], 0.5f * static_cast<float>(height_) - scale * at[1],
            -at[2]};
  }

  // Keeps the depth of the nearest surface at the middle of every pixel that the triangle covers.
  void cover(std::span<const std::uint32_t> triangle) {
    const std::array<float, 3>&a = points_[triangle[0]], &b = points_[triangle[1]], &c = points_[triangle[2]];
    const float area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    if (area == 0) return;
    const auto first = [](float low) { return static_cast<std::uint32_t>(std::max(0.0f, std::floor(low))); };
    const auto end = [](float high, std::uint32_t size) {
      return static_cast<std::uint32_t>(std::clamp(std::ceil(high), 0.0f, static_cast<float>(size)));
    };
    for (std::uint32_t y = first(std::min({a[1], b[1], c[1]})); y < end(std::max({a[1], b[1], c[1]}), height_); ++y) {
      for (std::uint32_t x = first(std::min({a[0], b[0], c[0]})); x < end(std::max({a[0], b[0], c[0]}), width_); ++x) {
        const float right = static_cast<float>(x) + 0.5f - a[0], down = static_cast<float>(y) + 0.5f - a[1];
        const float of_b = (right * (c[1] - a[1]) - (c[0] - a[0]) * down) / area;
        const float of_c = ((b[0] - a[0]) * down - right * (b[1] - a[1])) / area;
        if (of_b < 0 || of_c < 0 || of_b + of_c > 1) continue;
        float& depth = depths_[std::size_t{y} * width_ + x];
        depth = std::min(depth, a[2] + of_b * (b[2] - a[2]) + of_c * (c[2] - a[2]));
      }
    }
  }

  bool faces(std::uint32_t vertex) const {
    constexpr float kEdgeOn = 0.3f;
    float towards = 0, distance2 = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const float to_eye = camera_.eye[i] - skin_[3 * std::size_t{vertex} + i];
      towards += normals_[3 * std::size_t{vertex} + i] * to_eye;
      distance2 += to_eye * to_eye;
    }
    return towards > kEdgeOn * std::sqrt(distance2);
  }

  // It faces the camera, and nothing stands before it.
  bool is_seen(std::uint32_t vertex) const {
    if (!faces(vertex)) return false;
    const auto [x, y, depth] = points_[vertex];
    if (!(x >= 0 && y >= 0 && x < static_cast<float>(width_) && y < static_cast<float>(height_))) return false;
    return depth <= depths_[static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x)] + tolerance_;
  }

  std::array<float, 2> pixel(std::uint32_t vertex) const { return {points_[vertex][0], points_[vertex][1]}; }

  std::span<const float> skin_, normals_;
  draw::Camera camera_;
  std::array<std::array<float, 4>, 3> view_;
  float scale_;  // pixels to the tangent of an angle
  std::uint32_t width_, height_;
  std::vector<float> depths_;                 // metres, row by row; infinity where there is no skin
  std::vector<std::array<float, 3>> points_;  // V, as seen
  float tolerance_ = 0;                       // metres
};

constexpr int kColumns = 3, kRows = 5, kScale = 3, kMargin = 3;  // of a digit; pixels a dot; pixels around the number

// Dots of every digit, row by row from the top left.
constexpr int kDigits[10] = {0b111'101'101'101'111, 0b010'110'010'010'111, 0b111'001'111'100'111, 0b111'001'111'001'111,
                             0b101'101'111'001'001, 0b111'100'111'001'111, 0b111'100'111'101'111, 0b111'001'001'001'001,
                             0b111'101'111'101'111, 0b111'101'111'001'111};

bool is_dot(const std::string& digits, int x, int y) {
  if (x < 0 || y < 0) return false;
  const int dot_x = x / kScale, row = y / kScale, column = dot_x % (kColumns + 1);
  const auto place = static_cast<std::size_t>(dot_x / (kColumns + 1));
  if (place >= digits.size() || column >= kColumns || row >= kRows) return false;
  return kDigits[digits[place] - '0'] >> (kRows * kColumns - 1 - (row * kColumns + column)) & 1;
}

}  // namespace

std::vector<std::array<float, 3>> region_colours(std::span<const DrawnRegion> regions, std::size_t vertices) {
  const std::vector<std::set<std::size_t>> neighbours = neighbours_of(regions, vertices);
  std::vector<draw::Oklab> colours = palette(regions.size());
  const auto clashes = [&](std::size_t r) {
    double sum = 0;
    for (const std::size_t other : neighbours[r]) sum += clash(colours[r], colours[other]);
    return sum;
  };
  // Swaps while a swap helps.
  for (bool better = true; better;) {
    better = false;
    for (std::size_t a = 0; a < colours.size(); ++a) {
      for (std::size_t b = a + 1; b < colours.size(); ++b) {
        const double before = clashes(a) + clashes(b);
        std::swap(colours[a], colours[b]);
        if (clashes(a) + clashes(b) < 0.999 * before) {
          better = true;
        } else {
          std::swap(colours[a], colours[b]);
        }
      }
    }
  }
  return transformed(colours, [&](const draw::Oklab& colour) { return draw::linear_rgb(colour); });
}

RegionPicture region_picture(draw::Renderer& renderer, std::span<const float> skin,
                             std::span<const std::uint32_t> triangles, std::span<const DrawnRegion> regions,
                             std::span<const std::array<float, 3>> colours, std::uint32_t panel_width,
                             std::uint32_t panel_height, std::span<const std::array<float, 3>> directions) {
  constexpr float kInNone = 0.3f;  // grey, linear
  std::vector<float> blended(skin.size(), kInNone);
  for (std::size_t r = 0; r < regions.size(); ++r) {
    for (std::size_t k = 0; k < regions[r].vertices.size(); ++k) {
      for (std::size_t i = 0; i < 3; ++i) {
        blended[3 * std::size_t{regions[r].vertices[k]} + i] +=
            static_cast<float>(regions[r].weights[k]) * (colours[r][i] - kInNone);
      }
    }
  }
  const std::vector<float> normals = smooth_normals(triangles, skin);
  const draw::DrawMesh mesh{skin, normals, triangles, blended};
  std::vector<draw::Image> panels;
  std::vector<bool> is_numbered(regions.size(), false);
  for (const std::array<float, 3>& direction : directions) {
    const draw::Camera camera = framed(skin, direction, panel_width, panel_height);
    draw::Image& image = panels.emplace_back(renderer.draw(std::span(&mesh, 1), camera, panel_width, panel_height));
    const RegionPanel panel(skin, normals, triangles, camera, image);
    for (std::size_t r = 0; r < regions.size(); ++r) {
      const auto place = panel.place_of(regions[r]);
      if (!place) continue;
      draw_number(image, static_cast<int>(r) + 1, static_cast<int>((*place)[0]), static_cast<int>((*place)[1]));
      is_numbered[r] = true;
    }
  }
  RegionPicture picture{side_by_side(panels), {}};
  for (std::size_t r = 0; r < regions.size(); ++r) {
    if (!is_numbered[r]) picture.unnumbered.push_back(r + 1);
  }
  return picture;
}

void draw_number(draw::Image& image, int number, int x, int y) {
  const std::string digits = std::to_string(number);
  const int width = kScale * ((kColumns + 1) * static_cast<int>(digits.size()) - 1) + 2 * kMargin;
  const int height = kScale * kRows + 2 * kMargin;
  const int right = static_cast<int>(image.width) - width, bottom = static_cast<int>(image.height) - height;
  const int left = std::max(0, std::min(x - width / 2, right)), top = std::max(0, std::min(y - height / 2, bottom));
  for (int j = 0; j < std::min(height, static_cast<int>(image.height)); ++j) {
    for (int i = 0; i < std::min(width, static_cast<int>(image.width)); ++i) {
      const std::uint8_t shade = is_dot(digits, i - kMargin, j - kMargin) ? 255 : 30;
      const auto pixel = static_cast<std::size_t>(top + j) * image.width + static_cast<std::size_t>(left + i);
      std::fill_n(image.rgba.begin() + static_cast<std::ptrdiff_t>(4 * pixel), 3, shade);
    }
  }
}

std::vector<std::array<float, 3>> sides_of(const Positions& vertices, const Triangles& triangles,
                                           std::span<const VertexList> places) {
  constexpr std::array<std::array<float, 3>, 6> kSides = {
      {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}}};
  constexpr double kFacing = 0.5;  // cosine
  const Positions normals = vertex_normals(vertices, triangles).rowwise().normalized();
  std::array<bool, kSides.size()> is_seen = {true};
  for (const VertexList& place : places) {
    std::array<int, kSides.size()> facing{};
    for (const std::uint32_t v : place) {
      for (std::size_t s = 0; s < kSides.size(); ++s) {
        const Eigen::RowVector3d side(kSides[s][0], kSides[s][1], kSides[s][2]);
        if (normals.row(v).dot(side) > kFacing) ++facing[s];
      }
    }
    is_seen[static_cast<std::size_t>(std::ranges::max_element(facing) - facing.begin())] = true;
  }
  std::vector<std::array<float, 3>> sides;
  for (std::size_t s = 0; s < kSides.size(); ++s) {
    if (is_seen[s]) sides.push_back(kSides[s]);
  }
  return sides;
}

RegionPicture places_picture(draw::Renderer& renderer, const Positions& vertices, const Triangles& triangles,
                             std::span<const VertexList> places, std::uint32_t panel_width,
                             std::uint32_t panel_height) {
  const auto count = static_cast<std::size_t>(vertices.rows());
  std::vector<bool> is_taken(count, false);
  std::vector<VertexList> own;
  for (const VertexList& place : places) {
    own.emplace_back();
    for (const std::uint32_t v : place) {
      if (!is_taken[v]) own.back().push_back(v);
      is_taken[v] = true;
    }
  }
  const std::vector<double> whole(count, 1.0);
  std::vector<DrawnRegion> drawn;
  for (const VertexList& vertices_of : own) drawn.push_back({vertices_of, std::span(whole).first(vertices_of.size())});
  return region_picture(renderer, floats_of(vertices), flat(triangles), drawn, region_colours(drawn, count),
                        panel_width, panel_height, sides_of(vertices, triangles, places));
}

}  // namespace bodyopt::report
