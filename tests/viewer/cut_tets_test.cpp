#include "proxy_viewer/cut_tets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "tests/support/corotated_matrix.h"

namespace bodyopt::testing {
namespace {

Vec3 point(std::span<const float> nodes, std::uint32_t n) {
  return {nodes[3 * std::size_t{n}], nodes[3 * std::size_t{n} + 1], nodes[3 * std::size_t{n} + 2]};
}

// Six times the volume that triangles enclose.
double volume(std::span<const float> nodes, const CutFaces& faces) {
  double sum = 0;
  for (const auto* triangles : {&faces.skin, &faces.fat, &faces.muscle}) {
    for (std::size_t k = 0; k < triangles->size(); k += 3) {
      sum += dot(point(nodes, (*triangles)[k]),
                 cross(point(nodes, (*triangles)[k + 1]), point(nodes, (*triangles)[k + 2])));
    }
  }
  return sum;
}

double volume(std::span<const float> nodes, std::span<const std::uint32_t> tet) {
  const Vec3 o = point(nodes, tet[0]);
  return dot(point(nodes, tet[1]) - o, cross(point(nodes, tet[2]) - o, point(nodes, tet[3]) - o));
}

class CutTetsTest : public ::testing::Test {
 protected:
  TetTable block_ = block_tets(4, 3, 5);
  TetCutter cutter_{block_.tets, std::vector<bool>(block_.tets.size() / 4, false)};
  Vec3 towards_{0.6, 0, 0.8};
};

// What is kept is closed and encloses the tets that are far enough: by an independent sum.
TEST_F(CutTetsTest, EnclosesWhatIsKept) {
  std::vector<double> depth;
  for (std::size_t t = 0; t < block_.tets.size(); t += 4) {
    Vec3 sum{};
    for (std::size_t k = 0; k < 4; ++k) sum = sum + point(block_.nodes, block_.tets[t + k]);
    depth.push_back(0.25 * dot(sum, towards_));
  }
  const auto [low, high] = std::ranges::minmax(depth);
  double before = 1e30;
  for (const double share : {0.0, 0.3, 0.55, 0.8}) {
    double expected = 0;
    for (std::size_t t = 0; t < depth.size(); ++t) {
      const bool kept = depth[t] <= high - share * (high - low);
      if (kept) expected += volume(block_.nodes, std::span(block_.tets).subspan(4 * t, 4));
    }
    const CutFaces faces = cutter_.cut(block_.nodes, towards_, share);
    EXPECT_NEAR(volume(block_.nodes, faces), expected, 1e-5 * expected) << share;
    EXPECT_LT(expected, before);
    EXPECT_EQ(faces.fat.empty(), share == 0);
    before = expected;
  }
}

TEST_F(CutTetsTest, UncutIsTheSurfaceAlone) {
  const CutFaces faces = cutter_.cut(block_.nodes, towards_, 0);
  std::map<std::set<std::uint32_t>, int> count;
  for (std::size_t t = 0; t < block_.tets.size(); t += 4) {
    for (std::size_t left = 0; left < 4; ++left) {
      std::set<std::uint32_t> face;
      for (std::size_t k = 0; k < 4; ++k) {
        if (k != left) face.insert(block_.tets[t + k]);
      }
      ++count[face];
    }
  }
  const auto outer = std::ranges::count_if(count, [](const auto& face) { return face.second == 1; });
  EXPECT_EQ(faces.skin.size(), 3 * static_cast<std::size_t>(outer));
}

TEST_F(CutTetsTest, ColoursMuscles) {
  const TetCutter muscles(block_.tets, std::vector<bool>(block_.tets.size() / 4, true));
  const CutFaces faces = muscles.cut(block_.nodes, towards_, 0.5), fat = cutter_.cut(block_.nodes, towards_, 0.5);
  EXPECT_TRUE(faces.fat.empty());
  EXPECT_EQ(faces.muscle, fat.fat);
  EXPECT_EQ(faces.skin, fat.skin);
}

}  // namespace
}  // namespace bodyopt::testing
