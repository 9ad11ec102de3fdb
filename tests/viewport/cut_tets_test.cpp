#include "viewport/scene/cut_tets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "tests/simulate/tet_block.h"
#include "tests/support/random_tets.h"

namespace bodyopt::testing {
namespace {

using namespace viewport;

Vec3 point(std::span<const float> nodes, std::uint32_t n) {
  return {nodes[3 * std::size_t{n}], nodes[3 * std::size_t{n} + 1], nodes[3 * std::size_t{n} + 2]};
}

// Six times the volume that triangles enclose.
double volume(std::span<const float> nodes, const CutFaces& faces) {
  double sum = 0;
  for (const auto* triangles : {&faces.skin, &faces.inside[0], &faces.inside[1], &faces.inside[2]}) {
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

// Of cubes with edges of 1.
TetTable block_tets(int nx, int ny, int nz) {
  const TetMesh mesh = tet_block(nx, ny, nz, 1);
  TetTable table;
  for (Eigen::Index n = 0; n < mesh.nodes.rows(); ++n) append_point(table.nodes, mesh.nodes.row(n).transpose());
  for (Eigen::Index k = 0; k < mesh.tets.size(); ++k) {
    table.tets.push_back(static_cast<std::uint32_t>(mesh.tets(k / 4, k % 4)));
  }
  complete_tets(table);
  return table;
}

class CutTetsTest : public ::testing::Test {
 protected:
  TetTable block_ = block_tets(4, 3, 5);
  TetCutter cutter_{block_.tets, std::vector<TetKind>(block_.tets.size() / 4, TetKind::fat)};
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
    EXPECT_EQ(faces.inside[0].empty(), share == 0);
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

TEST_F(CutTetsTest, ColoursKinds) {
  const CutFaces fat = cutter_.cut(block_.nodes, towards_, 0.5);
  for (const TetKind kind : {TetKind::muscle, TetKind::held}) {
    const TetCutter other(block_.tets, std::vector<TetKind>(block_.tets.size() / 4, kind));
    const CutFaces faces = other.cut(block_.nodes, towards_, 0.5);
    EXPECT_TRUE(faces.inside[0].empty());
    EXPECT_EQ(faces.inside[static_cast<std::size_t>(kind)], fat.inside[0]);
    EXPECT_EQ(faces.skin, fat.skin);
  }
}

// Springs of 28 Hz hold what lies below x = 1, those of 14 Hz at 2 do not; fibres run at 0 and from 3 on.
TEST_F(CutTetsTest, HeldIsWhatSpringsHoldAtEveryCorner) {
  Dynamics dynamics;
  dynamics.tets = block_;
  JiggleTable& jiggle = dynamics.jiggle;
  const std::uint32_t nodes = block_.node_count();
  for (std::uint32_t n = 0; n < nodes; ++n) {
    const double x = point(block_.nodes, n)[0], hertz = x < 1.5 ? 28 : x < 2.5 ? 14 : 0;
    const auto spring = static_cast<float>(0.5 * std::pow(2 * std::numbers::pi * hertz, 2));  // N/m, of 0.5 kg
    const bool has_fibre = x < 0.5 || x > 2.5;
    jiggle.nodes.push_back({0.5f, 700, 0, has_fibre ? 1u : 0u, kNoControl, 0});
    jiggle.springs.push_back(spring);
  }
  const std::vector<TetKind> kinds = kinds_of(dynamics);
  ASSERT_EQ(kinds.size(), block_.tet_count());
  std::map<TetKind, int> counts;
  for (std::uint32_t t = 0; t < kinds.size(); ++t) {
    int held = 0, fibres = 0;
    for (std::uint32_t k = 0; k < 4; ++k) {
      const double x = point(block_.nodes, block_.tets[4 * t + k])[0];
      held += x < 1.5;
      fibres += x > 2.5;
    }
    EXPECT_EQ(kinds[t], held == 4 ? TetKind::held : fibres >= 3 ? TetKind::muscle : TetKind::fat) << t;
    ++counts[kinds[t]];
  }
  for (const TetKind kind : {TetKind::fat, TetKind::muscle, TetKind::held}) EXPECT_GT(counts[kind], 10);
}

}  // namespace
}  // namespace bodyopt::testing
