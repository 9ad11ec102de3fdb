// Colours and numbers of regions on a skin.
#include "report/region_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/draw/sphere.h"
#include "tests/report/white_dots.h"

namespace bodyopt::report {
namespace {

using namespace draw;

double distance(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

TEST(RegionColours, AreDifferentAndMostOfAllForNeighbours) {
  // A chain: every region shares a vertex with the next one.
  constexpr std::uint32_t kCount = 40;
  std::vector<std::vector<std::uint32_t>> vertices;
  const std::vector<double> weights = {0.5, 0.5};
  std::vector<DrawnRegion> regions;
  for (std::uint32_t r = 0; r < kCount; ++r) vertices.push_back({r, r + 1});
  for (const auto& pair : vertices) regions.push_back({pair, weights});
  const auto colours = region_colours(regions, kCount + 1);
  ASSERT_EQ(colours.size(), kCount);
  double least_of_all = 1e9, least_of_neighbours = 1e9;
  for (std::size_t a = 0; a < kCount; ++a) {
    for (std::size_t b = a + 1; b < kCount; ++b) {
      const double d = distance(colours[a], colours[b]);
      least_of_all = std::min(least_of_all, d);
      if (b == a + 1) least_of_neighbours = std::min(least_of_neighbours, d);
    }
  }
  EXPECT_GT(least_of_all, 0.005);
  EXPECT_GT(least_of_neighbours, 0.3);
}

TEST(NumberLabel, HasTheDotsOfItsDigitsAndStaysInside) {
  for (const auto& [x, y] : {std::pair(20, 20), std::pair(-50, 900)}) {
    Image image{40, 40, std::vector<std::uint8_t>(std::size_t{4} * 40 * 40, 100)};
    draw_number(image, 18, x, y);
    EXPECT_EQ(testing::white_dots(image, 0, 40), 8u + 13);  // 8 in this 1, 13 in the 8
  }
}

TEST(RegionPicture, ShowsEveryRegionWhereItIsSeen) {
  // Two halves of a sphere: the front one is number 1.
  const testing::Sphere sphere(0.5f);
  std::vector<std::uint32_t> front, back;
  for (std::uint32_t v = 0; v < sphere.positions.size() / 3; ++v) {
    (sphere.positions[3 * v + 2] > 0 ? front : back).push_back(v);
  }
  const std::vector<double> ones(sphere.positions.size() / 3, 1.0);
  const DrawnRegion regions[] = {{front, {ones.data(), front.size()}}, {back, {ones.data(), back.size()}}};
  const std::array<float, 3> colours[] = {{0.8f, 0.02f, 0.02f}, {0.02f, 0.02f, 0.8f}};
  Renderer renderer;
  const Image image = region_picture(renderer, sphere.positions, sphere.triangles, regions, colours, 200, 200).image;
  ASSERT_EQ(image.width, 400u);
  const auto sum = [&](std::size_t begin, std::size_t channel) {
    double total = 0;
    for (std::size_t y = 60; y < 80; ++y) {
      for (std::size_t x = begin + 60; x < begin + 80; ++x) total += image.rgba[4 * (y * 400 + x) + channel];
    }
    return total;
  };
  EXPECT_GT(sum(0, 0), 2 * sum(0, 2));
  EXPECT_GT(sum(200, 2), 2 * sum(200, 0));
  EXPECT_EQ(testing::white_dots(image, 0, 200), 8u);     // a 1 in front
  EXPECT_EQ(testing::white_dots(image, 200, 400), 11u);  // a 2 behind
}

// As the flanks of an animal.
TEST(RegionPicture, ASideIsNumberedWhereItIsSeenFrom) {
  const testing::Sphere sphere(0.5f);
  std::vector<std::uint32_t> side;
  for (std::uint32_t v = 0; v < sphere.positions.size() / 3; ++v) {
    if (sphere.positions[3 * v] > 0.48f) side.push_back(v);
  }
  const std::vector<double> ones(side.size(), 1.0);
  const DrawnRegion regions[] = {{side, ones}};
  const std::array<float, 3> colours[] = {{0.8f, 0.02f, 0.02f}};
  Renderer renderer;
  const auto drawn = [&](std::span<const std::array<float, 3>> directions) {
    return region_picture(renderer, sphere.positions, sphere.triangles, regions, colours, 200, 200, directions);
  };
  EXPECT_EQ(drawn(kFrontAndBack).unnumbered, std::vector<std::size_t>{1});
  const RegionPicture around = drawn(kAllAround);
  EXPECT_TRUE(around.unnumbered.empty());
  EXPECT_EQ(testing::white_dots(around.image, 200, 400), 8u);  // a 1 on the left
}

TEST(RegionPicture, NumbersNothingThatStandsBehindTheBody) {
  // A small ball behind a large one: both face the camera.
  testing::Sphere all(0.5f), small(0.2f);
  const auto large_count = static_cast<std::uint32_t>(all.positions.size() / 3);
  for (std::size_t k = 2; k < small.positions.size(); k += 3) small.positions[k] -= 1;
  all.positions.insert(all.positions.end(), small.positions.begin(), small.positions.end());
  for (const std::uint32_t v : small.triangles) all.triangles.push_back(large_count + v);
  std::vector<std::uint32_t> large, behind;
  for (std::uint32_t v = 0; v < all.positions.size() / 3; ++v) (v < large_count ? large : behind).push_back(v);
  const std::vector<double> ones(all.positions.size() / 3, 1.0);
  const DrawnRegion regions[] = {{large, {ones.data(), large.size()}}, {behind, {ones.data(), behind.size()}}};
  const std::array<float, 3> colours[] = {{0.8f, 0.02f, 0.02f}, {0.02f, 0.02f, 0.8f}};
  Renderer renderer;
  const Image image = region_picture(renderer, all.positions, all.triangles, regions, colours, 200, 200).image;
  EXPECT_EQ(testing::white_dots(image, 0, 200), 8u);  // a 1, and no 2
}

}  // namespace
}  // namespace bodyopt::report
