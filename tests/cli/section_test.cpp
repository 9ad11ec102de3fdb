#include "report/section.h"

#include <gtest/gtest.h>

#include <cmath>

namespace bodyopt {
namespace {

// A cube of edge 2 around the origin: 8 corners, 12 triangles, 5 tets.
const std::vector<double> kCorners{-1, -1, -1, 1, -1, -1, -1, 1, -1, 1, 1, -1, -1, -1, 1, 1, -1, 1, -1, 1, 1, 1, 1, 1};
const std::vector<std::uint32_t> kTriangles{0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                            2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
const std::vector<int> kTets{0, 1, 2, 4, 3, 2, 1, 7, 5, 4, 7, 1, 6, 7, 4, 2, 1, 2, 4, 7};

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

// Whatever the plane, the rest of the surface and the cut face close up, and the face looks out.
TEST(Section, FaceAndSurfaceCloseUp) {
  const std::vector<float> positions(kCorners.begin(), kCorners.end());
  const std::vector<float> normals(positions.size(), 0.5f);
  const std::vector<std::array<float, 3>> colours(5, {1, 0, 0});
  for (const Vec3& direction : {Vec3{1, 0, 0}, Vec3{0, 0.6, -0.8}, Vec3{0.48, 0.6, 0.64}}) {
    for (const double offset : {-0.7, 0.0, 0.3}) {
      const CutPlane plane{offset * direction, direction};
      const Area surface = area_of(cut_surface(positions, normals, kTriangles, {1, 1, 1}, plane));
      const Area face = area_of(cut_face(kCorners, kTets, colours, plane));
      EXPECT_LT(length(surface.vector + face.vector), 1e-5);
      EXPECT_NEAR(length(face.vector), face.total, 1e-5);
      EXPECT_NEAR(dot(face.vector, direction), face.total, 1e-5);
      if (direction[0] == 1) {
        EXPECT_NEAR(face.total, 4, 1e-5);
        EXPECT_NEAR(surface.total, 4 + 8 * (1 + offset), 1e-5);
      }
    }
  }
  const CutPlane beside{{3, 0, 0}, {1, 0, 0}};
  EXPECT_TRUE(cut_face(kCorners, kTets, colours, beside).triangles.empty());
  EXPECT_NEAR(area_of(cut_surface(positions, normals, kTriangles, {1, 1, 1}, beside)).total, 24, 1e-5);
}

}  // namespace
}  // namespace bodyopt
