#include "draw/cut_surface.h"

#include <algorithm>

#include "draw/colours.h"

namespace bodyopt::draw {
namespace {

struct Corner {
  Vec3 position, normal;
  double height;  // above the plane
};

double height_above(const CutPlane& plane, const Vec3& point) { return dot(plane.normal, point - plane.point); }

Corner between(const Corner& a, const Corner& b) {
  const double t = a.height / (a.height - b.height);
  return {a.position + t * (b.position - a.position), a.normal + t * (b.normal - a.normal), 0};
}

// A convex polygon as a fan.
void add_polygon(std::span<const Corner> corners, const std::array<float, 3>& colour, Soup& soup) {
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
    for (const Corner& corner : {corners[0], corners[k], corners[k + 1]}) {
      soup.triangles.push_back(static_cast<std::uint32_t>(soup.positions.size() / 3));
      const double length_of_normal = std::max(length(corner.normal), 1e-12);
      for (std::size_t i = 0; i < 3; ++i) {
        soup.positions.push_back(static_cast<float>(corner.position[i]));
        soup.normals.push_back(static_cast<float>(corner.normal[i] / length_of_normal));
        soup.colours.push_back(colour[i]);
      }
    }
  }
}

}  // namespace

Soup cut_surface(std::span<const float> positions, std::span<const float> normals,
                 std::span<const std::uint32_t> triangles, const std::array<float, 3>& colour, const CutPlane& plane) {
  Soup soup;
  for (std::size_t t = 0; t < triangles.size(); t += 3) {
    std::vector<Corner> kept;
    Corner corners[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t v = 3 * std::size_t{triangles[t + k]};
      corners[k].position = {positions[v], positions[v + 1], positions[v + 2]};
      corners[k].normal = {normals[v], normals[v + 1], normals[v + 2]};
      corners[k].height = height_above(plane, corners[k].position);
    }
    for (std::size_t k = 0; k < 3; ++k) {  // Sutherland and Hodgman 1974
      const Corner &a = corners[k], &b = corners[(k + 1) % 3];
      if (a.height <= 0) kept.push_back(a);
      if ((a.height < 0 && b.height > 0) || (a.height > 0 && b.height < 0)) kept.push_back(between(a, b));
    }
    add_polygon(kept, colour, soup);
  }
  return soup;
}

Soup standing_picture(const StandingPicture& picture) {
  Soup soup;
  const Vec3 out = cross(picture.down, picture.right);
  const Vec3 normal = 1 / length(out) * out;
  const std::size_t pixels = picture.rgba.size() / 4;
  for (std::size_t from = 0, to = 0; from < pixels; from = to) {
    const std::span colour = picture.rgba.subspan(4 * from, 4);
    const std::size_t row_end = (from / picture.width + 1) * picture.width;
    for (to = from + 1; to < row_end && std::ranges::equal(colour, picture.rgba.subspan(4 * to, 4));) ++to;
    if (colour[3] == 0) continue;
    const Vec3 top_left = picture.corner + static_cast<double>(from / picture.width) * picture.down +
                          static_cast<double>(from % picture.width) * picture.right;
    const Vec3 along = static_cast<double>(to - from) * picture.right;
    const Corner corners[] = {{top_left, normal, 0},
                              {top_left + picture.down, normal, 0},
                              {top_left + picture.down + along, normal, 0},
                              {top_left + along, normal, 0}};
    add_polygon(corners, {linear(colour[0]), linear(colour[1]), linear(colour[2])}, soup);
  }
  return soup;
}

}  // namespace bodyopt::draw
