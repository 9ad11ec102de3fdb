#include "report/pictures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "draw/colours.h"
#include "geometry/mesh.h"
#include "report/region_picture.h"
#include "runtime/core/error.h"

namespace bodyopt::report {
namespace {

void check_pair(const PosePair& pose) {
  const bool skinned_alike = pose.skinning.empty() || pose.skinning.size() == pose.truth.size();
  if (pose.truth.empty() || pose.truth.size() != pose.result.size() || !skinned_alike || pose.truth.size() % 3 != 0 ||
      pose.triangles.size() % 3 != 0) {
    throw Error(ErrorKind::mismatch, "picture: truth, skinning and result hold ", pose.truth.size(), ", ",
                pose.skinning.size(), " and ", pose.result.size(), " numbers, the triangles ", pose.triangles.size(),
                " corners; expected three per vertex, the same in all, and three corners");
  }
  const std::size_t vertices = pose.truth.size() / 3;
  if (std::ranges::any_of(pose.triangles, [&](std::uint32_t v) { return v >= vertices; })) {
    throw Error(ErrorKind::mismatch, "picture: a triangle names a vertex beyond the ", vertices, " there are");
  }
}

constexpr std::uint8_t kGround[] = {28, 28, 30, 255};

draw::Image ground(std::uint32_t width, std::uint32_t height) {
  draw::Image image{width, height, {}};
  image.rgba.reserve(std::size_t{4} * width * height);
  for (std::size_t pixel = 0; pixel < std::size_t{width} * height; ++pixel) {
    image.rgba.insert(image.rgba.end(), std::begin(kGround), std::end(kGround));
  }
  return image;
}

void paste(const draw::Image& picture, std::uint32_t left, std::uint32_t top, draw::Image& onto) {
  for (std::uint32_t y = 0; y < picture.height; ++y) {
    const auto from = picture.rgba.begin() + static_cast<std::ptrdiff_t>(std::size_t{4} * y * picture.width);
    const std::size_t at = std::size_t{4} * (std::size_t{top + y} * onto.width + left);
    std::copy_n(from, std::size_t{4} * picture.width, onto.rgba.begin() + static_cast<std::ptrdiff_t>(at));
  }
}

constexpr std::size_t kRings = 24, kSides = 10;
constexpr double kThinnest = 0.0015;  // metres: tendons, where the belly ends

struct Mesh {
  std::vector<float> positions, colours;
  std::vector<std::uint32_t> triangles;
};

void add_vertex(const Vec3& position, const Vec3& colour, Mesh& mesh) {
  for (std::size_t i = 0; i < 3; ++i) {
    mesh.positions.push_back(static_cast<float>(position[i]));
    mesh.colours.push_back(static_cast<float>(colour[i]));
  }
}

// Points at equal distances along a path.
std::vector<Vec3> resample(const std::vector<Vec3>& path) {
  std::vector<double> arc{0};
  for (std::size_t k = 1; k < path.size(); ++k) arc.push_back(arc.back() + length(path[k] - path[k - 1]));
  std::vector<Vec3> points;
  std::size_t k = 1;
  for (std::size_t ring = 0; ring < kRings; ++ring) {
    const double at = arc.back() * static_cast<double>(ring) / (kRings - 1);
    while (k + 1 < path.size() && arc[k] < at) ++k;
    const double t = std::clamp((at - arc[k - 1]) / std::max(arc[k] - arc[k - 1], 1e-12), 0.0, 1.0);
    points.push_back(path[k - 1] + t * (path[k] - path[k - 1]));
  }
  return points;
}

void add_tube(const MuscleTube& muscle, const Vec3& colour, Mesh& mesh) {
  const std::vector<Vec3> points = resample(muscle.path);
  const auto first = static_cast<std::uint32_t>(mesh.positions.size() / 3);
  Vec3 across = {1, 0, 0};
  for (std::size_t ring = 0; ring < kRings; ++ring) {
    Vec3 along = points[std::min(ring + 1, kRings - 1)] - points[ring == 0 ? 0 : ring - 1];
    along = (1 / std::max(length(along), 1e-12)) * along;
    across = across - dot(across, along) * along;
    if (length(across) < 0.1) across = cross(along, std::abs(along[1]) < 0.9 ? Vec3{0, 1, 0} : Vec3{0, 0, 1});
    across = (1 / length(across)) * across;
    const Vec3 other = cross(along, across);
    const double u = static_cast<double>(ring) / (kRings - 1);
    const double radius = std::max(muscle.radius * std::sqrt(std::max(std::sin(std::numbers::pi * u), 0.0)), kThinnest);
    for (std::size_t side = 0; side < kSides; ++side) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(side) / kSides;
      add_vertex(points[ring] + radius * (std::cos(angle) * across + std::sin(angle) * other), colour, mesh);
    }
  }
  for (std::uint32_t ring = 0; ring + 1 < kRings; ++ring) {
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const std::uint32_t next = (side + 1) % kSides;
      const std::uint32_t a = first + ring * kSides + side, b = first + ring * kSides + next;
      for (const std::uint32_t v : {a, b, a + static_cast<std::uint32_t>(kSides), b,
                                    b + static_cast<std::uint32_t>(kSides), a + static_cast<std::uint32_t>(kSides)}) {
        mesh.triangles.push_back(v);
      }
    }
  }
}

// Reds that differ, so that neighbours can be told apart.
Vec3 muscle_colour(std::size_t index) {
  const double shade = std::fmod(0.618034 * static_cast<double>(index), 1.0);
  return {0.45 + 0.35 * shade, 0.08 + 0.22 * std::fmod(3 * shade, 1.0), 0.07 + 0.1 * shade};
}

std::vector<std::uint32_t> facing_away(std::span<const std::uint32_t> triangles, std::span<const float> normals,
                                       const std::array<float, 3>& direction) {
  std::vector<std::uint32_t> kept;
  for (std::size_t t = 0; t < triangles.size(); t += 3) {
    float towards = 0;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      for (std::size_t i = 0; i < 3; ++i) towards += normals[3 * std::size_t{triangles[t + corner]} + i] * direction[i];
    }
    if (towards < 0)
      kept.insert(kept.end(), triangles.begin() + static_cast<std::ptrdiff_t>(t),
                  triangles.begin() + static_cast<std::ptrdiff_t>(t + 3));
  }
  return kept;
}

// V x 3, linear RGB: how far the result is from the truth, heat_colour() from 0 to scale_mm (> 0).
std::vector<float> heat_map(const PosePair& pose, double scale_mm) {
  std::vector<float> colours;
  colours.reserve(pose.truth.size());
  for (std::size_t v = 0; v < pose.truth.size(); v += 3) {
    double d[3];
    for (std::size_t i = 0; i < 3; ++i) {
      d[i] = static_cast<double>(pose.result[v + i]) - static_cast<double>(pose.truth[v + i]);
    }
    const double millimetres = 1000 * std::hypot(d[0], d[1], d[2]);
    const std::array<float, 3> colour = draw::heat_colour(static_cast<float>(std::min(1.0, millimetres / scale_mm)));
    colours.insert(colours.end(), colour.begin(), colour.end());
  }
  return colours;
}

}  // namespace

std::vector<float> smooth_normals(std::span<const std::uint32_t> triangles, std::span<const float> positions) {
  using Points = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
  const Eigen::Map<const Points> points(positions.data(), static_cast<Eigen::Index>(positions.size() / 3), 3);
  const Eigen::Map<const Triangles> corners(triangles.data(), static_cast<Eigen::Index>(triangles.size() / 3), 3);
  Positions normals = vertex_normals(points.cast<double>(), corners);
  for (auto normal : normals.rowwise()) normal.normalize();  // zero stays zero
  return floats_of(normals);
}

draw::Image draw_skin(draw::Renderer& renderer, std::span<const std::uint32_t> triangles, std::span<const float> skin,
                      std::span<const float> colours, const Panel& panel) {
  const std::vector<float> normals = smooth_normals(triangles, skin);
  const draw::DrawMesh mesh{skin, normals, triangles, colours};
  return renderer.draw(std::span(&mesh, 1), panel.camera, panel.width, panel.height);
}

draw::Image side_by_side(std::span<const draw::Image> panels) {
  const std::uint32_t width = panels[0].width;
  draw::Image whole = ground(static_cast<std::uint32_t>(panels.size()) * width, panels[0].height);
  for (std::uint32_t k = 0; k < panels.size(); ++k) paste(panels[k], k * width, 0, whole);
  return whole;
}

draw::Image comparison(draw::Renderer& renderer, const PosePair& pose, double scale_mm, const draw::Camera& camera,
                       std::uint32_t panel_width, std::uint32_t panel_height) {
  check_pair(pose);
  if (!(scale_mm > 0)) throw Error(ErrorKind::usage, "picture: the scale of the heat map must be above 0 mm");
  std::vector<draw::Image> panels;
  const auto add = [&](std::span<const float> skin, std::span<const float> colours) {
    panels.push_back(draw_skin(renderer, pose.triangles, skin, colours, {camera, panel_width, panel_height}));
  };
  add(pose.truth, {});
  if (!pose.skinning.empty()) add(pose.skinning, {});
  add(pose.result, {});
  add(pose.result, heat_map(pose, scale_mm));
  return side_by_side(panels);
}

draw::Image heat_on_skin(draw::Renderer& renderer, std::span<const float> skin,
                         std::span<const std::uint32_t> triangles, std::span<const double> heat,
                         std::uint32_t panel_width, std::uint32_t panel_height) {
  std::vector<float> colours;
  for (const double value : heat) {
    const std::array<float, 3> colour = draw::heat_colour(static_cast<float>(std::min(1.0, value)));
    colours.insert(colours.end(), colour.begin(), colour.end());
  }
  std::vector<draw::Image> panels;
  for (const std::array<float, 3>& direction : kFrontAndBack) {
    const draw::Camera camera = framed(skin, direction, panel_width, panel_height);
    panels.push_back(draw_skin(renderer, triangles, skin, colours, {camera, panel_width, panel_height}));
  }
  return side_by_side(panels);
}

std::array<float, 3> towards_worst(const PosePair& pose) {
  check_pair(pose);
  std::size_t worst = 0;
  float furthest = -1;
  for (std::size_t v = 0; v < pose.truth.size(); v += 3) {
    const float apart = std::hypot(pose.result[v] - pose.truth[v], pose.result[v + 1] - pose.truth[v + 1],
                                   pose.result[v + 2] - pose.truth[v + 2]);
    if (apart <= furthest) continue;
    furthest = apart;
    worst = v;
  }
  const std::vector<float> normals = smooth_normals(pose.triangles, pose.truth);
  return {normals[worst], normals[worst + 1], normals[worst + 2]};
}

double heat_scale(double largest) {
  if (!(largest > 0) || !std::isfinite(largest)) return 1;
  const double decade = std::pow(10.0, std::floor(std::log10(largest)));
  for (const double step : {1.0, 1.2, 1.6, 2.0, 2.4, 3.2, 4.0, 6.0, 8.0}) {
    if (largest <= step * decade * (1 + 1e-12)) return step * decade;
  }
  return 10 * decade;
}

draw::Camera frame_pose(const PosePair& pose, const std::array<float, 3>& direction, float aspect) {
  check_pair(pose);
  std::vector<float> points(pose.truth.begin(), pose.truth.end());
  points.insert(points.end(), pose.result.begin(), pose.result.end());
  return draw::frame_points(points, direction, aspect);
}

draw::Camera framed(std::span<const float> points, const std::array<float, 3>& direction, std::uint32_t width,
                    std::uint32_t height) {
  return draw::frame_points(points, direction, static_cast<float>(width) / static_cast<float>(height));
}

std::vector<draw::Image> flip_book_frames(draw::Renderer& renderer, const FlipBook& book, const Panel& panel) {
  std::vector<draw::Image> frames;
  for (std::size_t k = 0; k < book.still.size(); ++k) {
    const std::array panels{draw_skin(renderer, book.triangles, book.still[k], {}, panel),
                            draw_skin(renderer, book.triangles, book.jiggling[k], {}, panel)};
    frames.push_back(side_by_side(panels));
  }
  return frames;
}

draw::Image flip_book_strip(draw::Renderer& renderer, const FlipBook& book, std::span<const std::size_t> frames,
                            double scale_mm, const Panel& panel) {
  std::vector<draw::Image> still, jiggling;
  for (const std::size_t k : frames) {
    still.push_back(draw_skin(renderer, book.triangles, book.still[k], {}, panel));
    const std::vector<float> colours = heat_map({book.triangles, book.still[k], book.jiggling[k]}, scale_mm);
    jiggling.push_back(draw_skin(renderer, book.triangles, book.jiggling[k], colours, panel));
  }
  draw::Image strip = side_by_side(still);
  const draw::Image below = side_by_side(jiggling);
  strip.height += below.height;
  strip.rgba.insert(strip.rgba.end(), below.rgba.begin(), below.rgba.end());
  return strip;
}

draw::Image section_image(const trainer::TissueSection& section, const trainer::TissueColours& colours) {
  draw::Image image{static_cast<std::uint32_t>(section.width), static_cast<std::uint32_t>(section.height),
                    colours.picture(section)};
  for (std::size_t pixel = 0; pixel < image.rgba.size(); pixel += 4) {
    if (image.rgba[pixel + 3] == 0) std::ranges::copy(kGround, image.rgba.begin() + static_cast<std::ptrdiff_t>(pixel));
  }
  return image;
}

draw::Soup standing_section(const trainer::SectionPlane& plane, std::span<const std::uint8_t> rgba) {
  const auto vec = [](const Eigen::Vector3d& v) { return Vec3{v.x(), v.y(), v.z()}; };
  return draw::standing_picture({vec(plane.corner), vec(plane.pixel * plane.right), vec(plane.pixel * plane.down),
                                 static_cast<std::uint32_t>(plane.width), rgba});
}

draw::Image numbered_sheet(std::span<const draw::Image> pictures, std::uint32_t of_one) {
  constexpr std::uint32_t kColumns = 4, kMargin = 6;
  std::uint32_t width = 1, height = 1;
  for (const draw::Image& picture : pictures) {
    width = std::max(width, picture.width + 2 * kMargin);
    height = std::max(height, picture.height + 2 * kMargin);
  }
  const auto count = static_cast<std::uint32_t>(pictures.size());
  const std::uint32_t columns = std::clamp(count, 1u, kColumns), rows = std::max(1u, (count + kColumns - 1) / kColumns);
  draw::Image sheet = ground(columns * width, rows * height);
  for (std::uint32_t k = 0; k < count; ++k) {
    const draw::Image& picture = pictures[k];
    const std::uint32_t left = k % kColumns * width, top = k / kColumns * height;
    paste(picture, left + (width - picture.width) / 2, top + (height - picture.height) / 2, sheet);
    if (k % of_one != 0) continue;
    draw_number(sheet, static_cast<int>(k / of_one) + 1, static_cast<int>(left) + 16, static_cast<int>(top) + 16);
  }
  return sheet;
}

draw::Image muscle_picture(draw::Renderer& renderer, std::span<const float> skin,
                           std::span<const std::uint32_t> triangles, std::span<const MuscleTube> muscles,
                           std::uint32_t panel_width, std::uint32_t panel_height) {
  Mesh tubes;
  for (std::size_t m = 0; m < muscles.size(); ++m) add_tube(muscles[m], muscle_colour(m), tubes);
  const std::vector<float> tube_normals = smooth_normals(tubes.triangles, tubes.positions);
  const std::vector<float> skin_normals = smooth_normals(triangles, skin);
  // Seen from inside, the skin is lit from inside.
  std::vector<float> inner_normals = skin_normals;
  for (float& value : inner_normals) value = -value;
  std::vector<draw::Image> panels;
  for (const std::array<float, 3>& direction :
       {std::array{0.0f, 0.0f, 1.0f}, std::array{0.0f, 0.0f, -1.0f}, std::array{1.0f, 0.0f, 0.0f}}) {
    const std::vector<std::uint32_t> shell = facing_away(triangles, skin_normals, direction);
    const draw::DrawMesh meshes[2] = {{skin, inner_normals, shell, {}},
                                      {tubes.positions, tube_normals, tubes.triangles, tubes.colours}};
    const draw::Camera camera = framed(skin, direction, panel_width, panel_height);
    panels.push_back(renderer.draw(meshes, camera, panel_width, panel_height));
  }
  return side_by_side(panels);
}

}  // namespace bodyopt::report
