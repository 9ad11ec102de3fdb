// Places of a skin, numbered, from the sides where they are.
#include <gtest/gtest.h>

#include "report/region_picture.h"
#include "tests/draw/sphere.h"
#include "tests/report/white_dots.h"

namespace bodyopt::report {
namespace {

using namespace draw;

constexpr std::uint32_t kSide = 200;  // pixels

class PlacesPicture : public ::testing::Test {
 protected:
  PlacesPicture() {
    const testing::Sphere sphere(0.5f);
    vertices_ = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(
                    sphere.positions.data(), static_cast<Eigen::Index>(sphere.positions.size()) / 3, 3)
                    .cast<double>();
    triangles_ =
        Eigen::Map<const Triangles>(sphere.triangles.data(), static_cast<Eigen::Index>(sphere.triangles.size()) / 3, 3);
  }

  // What lies further than four fifths of the radius that way.
  VertexList cap(int axis, double sign) const {
    VertexList place;
    for (Eigen::Index v = 0; v < vertices_.rows(); ++v) {
      if (sign * vertices_(v, axis) > 0.4) place.push_back(static_cast<std::uint32_t>(v));
    }
    return place;
  }
  std::vector<std::array<float, 3>> sides(const std::vector<VertexList>& places) const {
    return sides_of(vertices_, triangles_, places);
  }
  Image picture(const std::vector<VertexList>& places) const {
    Renderer renderer;
    return places_picture(renderer, vertices_, triangles_, places, kSide, kSide).image;
  }

  Positions vertices_;
  Triangles triangles_;
};

using Sides = std::vector<std::array<float, 3>>;

TEST_F(PlacesPicture, IsFromTheFrontAndWherePlacesFace) {
  EXPECT_EQ(sides({}), (Sides{{0, 0, 1}}));
  EXPECT_EQ(sides({cap(2, 1)}), (Sides{{0, 0, 1}}));
  EXPECT_EQ(sides({cap(1, -1), cap(0, -1), cap(1, -1)}), (Sides{{0, 0, 1}, {-1, 0, 0}, {0, -1, 0}}));
}

TEST_F(PlacesPicture, NumbersPlacesAndNotTheRest) {
  const Image none = picture({});
  ASSERT_EQ(none.width, kSide);
  EXPECT_EQ(testing::white_dots(none, 0, kSide), 0u);
  const Image below = picture({cap(1, -1)});
  ASSERT_EQ(below.width, 2 * kSide);
  EXPECT_EQ(testing::white_dots(below, 0, kSide), 0u);          // from the front
  EXPECT_EQ(testing::white_dots(below, kSide, 2 * kSide), 8u);  // a 1, seen from below
  const std::size_t middle = 4 * (std::size_t{kSide} / 2 * below.width + kSide / 2);
  EXPECT_EQ(below.rgba[middle], below.rgba[middle + 2]) << "the rest is grey";
}

// What is listed twice has the colour of the first.
TEST_F(PlacesPicture, AVertexOfSeveralPlacesHasTheColourOfTheFirst) {
  const VertexList front = cap(2, 1);
  EXPECT_EQ(testing::white_dots(picture({front, front}), 0, kSide), 8u);
}

// A small sphere within the large one.
TEST_F(PlacesPicture, SaysWhichPlacesAreHidden) {
  const Eigen::Index vertices = vertices_.rows(), triangles = triangles_.rows();
  vertices_.conservativeResize(2 * vertices, 3);
  vertices_.bottomRows(vertices) = 0.3 * vertices_.topRows(vertices);
  triangles_.conservativeResize(2 * triangles, 3);
  triangles_.bottomRows(triangles) = triangles_.topRows(triangles).array() + static_cast<std::uint32_t>(vertices);
  VertexList inside;
  for (Eigen::Index v = vertices; v < 2 * vertices; ++v) inside.push_back(static_cast<std::uint32_t>(v));
  Renderer renderer;
  const std::vector<VertexList> places = {cap(2, 1), inside, cap(1, 1)};
  EXPECT_EQ(places_picture(renderer, vertices_, triangles_, places, kSide, kSide).unnumbered,
            (std::vector<std::size_t>{2}));
}

}  // namespace
}  // namespace bodyopt::report
