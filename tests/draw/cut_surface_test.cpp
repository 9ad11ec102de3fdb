#include "draw/cut_surface.h"

#include <gtest/gtest.h>

#include <cmath>

namespace bodyopt::draw {
namespace {

// A cube of edge 2 around the origin: 8 corners, 12 triangles.
const std::vector<float> kCorners{-1, -1, -1, 1, -1, -1, -1, 1, -1, 1, 1, -1, -1, -1, 1, 1, -1, 1, -1, 1, 1, 1, 1, 1};
const std::vector<std::uint32_t> kTriangles{0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                            2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};

struct Area {
  double total = 0;
  Vec3 vector{0, 0, 0};  // by winding
};

Area area_of(const Soup& soup) {
  Area area;
  for (std::size_t t = 0; t < soup.triangles.size(); t += 3) {
    Vec3 p[3];
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < 3; ++i) p[k][i] = soup.positions[3 * soup.triangles[t + k] + i];
    }
    const Vec3 half = 0.5 * cross(p[1] - p[0], p[2] - p[0]);
    area.total += length(half);
    area.vector = area.vector + half;
  }
  return area;
}

// A surface that lacks a flat face of some area has that as the sum of its own areas.
TEST(CutSurface, KeepsWhatIsBehindThePlane) {
  const std::vector<float> normals(kCorners.size(), 0.5f);
  for (const double offset : {-0.7, 0.0, 0.3}) {
    const CutPlane plane{{offset, 0, 0}, {1, 0, 0}};
    const Area surface = area_of(cut_surface(kCorners, normals, kTriangles, {1, 1, 1}, plane));
    EXPECT_NEAR(surface.total, 4 + 8 * (1 + offset), 1e-5);
    EXPECT_NEAR(surface.vector[0], -4, 1e-5);
    EXPECT_LT(std::hypot(surface.vector[1], surface.vector[2]), 1e-5);
  }
  const CutPlane oblique{{0, 0, 0}, {0, 0.6, -0.8}};
  const Area half = area_of(cut_surface(kCorners, normals, kTriangles, {1, 1, 1}, oblique));
  EXPECT_NEAR(length(half.vector), 4 / 0.8, 1e-5);
  const CutPlane beside{{3, 0, 0}, {1, 0, 0}};
  EXPECT_NEAR(area_of(cut_surface(kCorners, normals, kTriangles, {1, 1, 1}, beside)).total, 24, 1e-5);
}

// Three columns, two rows; what has no alpha is left out, what is of one colour in a row is one rectangle.
TEST(CutSurface, PicturesStandWhereTheirPixelsAre) {
  const std::vector<std::uint8_t> rgba{255, 0, 0, 255, 255, 0, 0, 255, 0, 0, 0,   0,
                                       0,   0, 0, 0,   0,   0, 0, 0,   0, 0, 255, 255};
  const Soup soup = standing_picture({{1, 2, 3}, {0.5, 0, 0}, {0, -0.25, 0}, 3, rgba});
  ASSERT_EQ(soup.triangles.size(), 2 * 6u);
  const Area area = area_of(soup);
  EXPECT_NEAR(area.total, 3 * 0.125, 1e-6);
  EXPECT_NEAR(area.vector[2], area.total, 1e-6);  // towards whom right is right and down is down
  EXPECT_FLOAT_EQ(soup.normals[2], 1);
  EXPECT_FLOAT_EQ(soup.colours[0], 1);
  EXPECT_FLOAT_EQ(soup.colours.back(), 1);
  float right = -1, low = 10;
  for (std::size_t k = 0; k < soup.positions.size(); k += 3) {
    right = std::max(right, soup.positions[k]);
    low = std::min(low, soup.positions[k + 1]);
  }
  EXPECT_FLOAT_EQ(right, 2.5f);
  EXPECT_FLOAT_EQ(low, 1.5f);
}

}  // namespace
}  // namespace bodyopt::draw
