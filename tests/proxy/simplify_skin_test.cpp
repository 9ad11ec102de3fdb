#include <gtest/gtest.h>

#include <algorithm>

#include "tests/builtin/shared_arm.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/sound_skin.h"
#include "tests/support/stand_in_human.h"
#include "trainer/proxy/build_proxy.h"
#include "trainer/proxy/level_skins.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::trainer {
namespace {

using namespace testing;

// The limb at rest, and bent at its elbow by some angles.
std::vector<Positions> bent_shapes(const Character& limb) {
  std::vector<Positions> shapes = {limb.vertices};
  for (const double angle : {0.8, 1.6}) shapes.push_back(skin_linear(limb, limb_pose(limb.skeleton, angle, 0, 0)));
  return shapes;
}

void expect_sound(const Character& character, const SimplifiedSkin& skin) {
  EXPECT_EQ(manifold_defect(skin.triangles, skin.vertices.size()), "");
  EXPECT_EQ(euler_characteristic(skin.triangles, skin.vertices.size()),
            euler_characteristic(character.triangles, static_cast<std::size_t>(character.vertices.rows())));
  EXPECT_TRUE(std::is_sorted(skin.vertices.begin(), skin.vertices.end()));
}

TEST(SimplifySkin, StaysClosedAndManifoldHoweverCoarse) {
  const Character limb = limb_character();
  std::size_t before = static_cast<std::size_t>(limb.vertices.rows());
  for (const double error : {5e-4, 2e-3, 1e-2, 1.0}) {
    SCOPED_TRACE(error);
    const SimplifiedSkin skin = simplify_skin(limb, bent_shapes(limb), error);
    expect_sound(limb, skin);
    EXPECT_LT(skin.vertices.size(), before);
    before = skin.vertices.size();
  }
}

TEST(SimplifySkin, AHumanStaysClosedAndManifold) {
  for (const Character& human : humans("characters/human_average.glb")) {
    for (const double error : {2e-3, 1e-2}) {
      const SimplifiedSkin skin = simplify_skin(human, {human.vertices}, error);
      expect_sound(human, skin);
      EXPECT_LT(skin.vertices.size(), 3000u);
    }
  }
}

TEST(SimplifySkin, NothingGoesWithoutAnError) {
  const Character& character = arm().character;  // nowhere flat
  const SimplifiedSkin skin = simplify_skin(character, {character.vertices}, 0);
  EXPECT_EQ(skin.vertices.size(), static_cast<std::size_t>(character.vertices.rows()));
  EXPECT_TRUE(skin.triangles == character.triangles);
}

// A straight tube tells nothing of its elbow at rest; the bent shapes do.
TEST(SimplifySkin, KeepsMoreWhereTheShapesBend) {
  const Character limb = limb_character();
  const auto at_elbow = [&](const SimplifiedSkin& skin) {
    const auto near = std::count_if(skin.vertices.begin(), skin.vertices.end(),
                                    [&](std::uint32_t v) { return std::abs(limb.vertices(v, 2) - 0.3) < 0.08; });
    return static_cast<double>(near) / static_cast<double>(skin.vertices.size());
  };
  const SimplifiedSkin straight = simplify_skin(limb, {limb.vertices}, 2e-3);
  const SimplifiedSkin bent = simplify_skin(limb, bent_shapes(limb), 2e-3);
  EXPECT_GT(at_elbow(bent), 1.3 * at_elbow(straight));
}

TEST(SimplifySkin, LiesWithinItsErrorRootMeanSquare) {
  const Character& character = arm().character;
  for (const double error : {1e-3, 4e-3}) {
    const Character proxy = proxy_character(character, simplify_skin(character, {character.vertices}, error));
    const SkinDistance distance = skin_distance(character, proxy);
    EXPECT_LT(distance.rms, 1e3 * error);
    EXPECT_GT(distance.rms, 0.2e3 * error);
    EXPECT_LT(distance.max, 5e3 * error);
  }
}

TEST(SimplifySkin, EveryJointKeepsSkin) {
  const Character& character = arm().character;
  const SimplifiedSkin skin = simplify_skin(character, {character.vertices}, 1.0);
  std::vector<int> full(character.skeleton.size()), kept(character.skeleton.size());
  for (const auto& weights : character.weights) ++full[weights.front().joint];
  for (const std::uint32_t v : skin.vertices) ++kept[character.weights[v].front().joint];
  for (std::size_t j = 0; j < kept.size(); ++j)
    EXPECT_GE(kept[j], std::min(full[j], 3)) << character.skeleton.joints[j].name;
  expect_sound(character, skin);
}

TEST(SimplifySkin, OpenEdgesStayAsTheyAre) {
  Character open = limb_character();
  const Triangles all = open.triangles;
  open.triangles = all.topRows(all.rows() - 40);  // both poles and some sides of the last columns
  const auto border = [](const Triangles& triangles, const auto& name) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
      for (int k = 0; k < 3; ++k) edges.insert({name(triangles(t, k)), name(triangles(t, (k + 1) % 3))});
    }
    std::erase_if(edges, [all = edges](const auto& edge) { return all.contains({edge.second, edge.first}); });
    return edges;
  };
  const SimplifiedSkin skin = simplify_skin(open, bent_shapes(open), 2e-3);
  EXPECT_LT(skin.triangles.rows(), open.triangles.rows() / 2);
  const auto full = border(open.triangles, [](std::uint32_t v) { return v; });
  EXPECT_GT(full.size(), 20u);
  EXPECT_EQ(border(skin.triangles, [&](std::uint32_t v) { return skin.vertices[v]; }), full);
}

TEST(ProxySamples, CarryTheSameNumbersAtTheVerticesThatStay) {
  SampleSet set = limb_samples(20, 4);
  set.regions = {{"painted", {3, 100, 300, 571}, {0.25, 0.5, 0.75, 1}}, {"tiny", {7}, {1}}};
  SimplifiedSkin skin = simplify_skin(set.character, bent_shapes(set.character), 1e-3);
  std::erase(skin.vertices, 7u);  // as if it had gone; triangles are not looked at here
  const SampleSet proxy = proxy_samples(set, skin);
  ASSERT_EQ(proxy.character.vertices.rows(), static_cast<Eigen::Index>(skin.vertices.size()));
  ASSERT_EQ(proxy.train.size(), 20u);
  ASSERT_EQ(proxy.heldout.size(), 4u);
  const Positions full = set.heldout[2].shape.read(), some = proxy.heldout[2].shape.read();
  std::map<std::uint32_t, double> painted;
  for (std::size_t k = 0; k < proxy.regions.at(0).vertices.size(); ++k) {
    painted[skin.vertices[proxy.regions[0].vertices[k]]] = proxy.regions[0].weights[k];
  }
  for (std::size_t v = 0; v < skin.vertices.size(); ++v) {
    const std::uint32_t there = skin.vertices[v];
    EXPECT_EQ(proxy.character.vertices.row(static_cast<Eigen::Index>(v)), set.character.vertices.row(there));
    EXPECT_EQ(some.row(static_cast<Eigen::Index>(v)), full.row(there));
    ASSERT_EQ(proxy.character.weights[v].size(), set.character.weights[there].size());
    EXPECT_EQ(proxy.character.weights[v][0].weight, set.character.weights[there][0].weight);
    for (const auto& [vertex, weight] : {std::pair(3u, 0.25), {100u, 0.5}, {300u, 0.75}, {571u, 1.0}}) {
      if (vertex == there) {
        EXPECT_EQ(painted[vertex], weight);
      }
    }
  }
  ASSERT_EQ(proxy.regions.size(), 1u);
  ASSERT_EQ(proxy.notes.size(), 1u);
  EXPECT_NE(proxy.notes[0].find("'tiny'"), std::string::npos) << proxy.notes[0];
}

}  // namespace
}  // namespace bodyopt::trainer
