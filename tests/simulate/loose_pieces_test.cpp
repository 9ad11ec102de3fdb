// Pieces that ride on a simulated body.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/simulate/limb.h"
#include "tests/simulate/one_take.h"
#include "tests/support/temporary_folder.h"
#include "trainer/simulate/loose_piece_stretch.h"
#include "trainer/simulate/simulate.h"

namespace bodyopt::trainer {
namespace {

constexpr int kRows = 6;

// A card of kRows pairs of vertices, `width` apart, from one place to another; all follow the same joints.
std::vector<std::uint32_t> add_card(const Eigen::RowVector3d& from, const Eigen::RowVector3d& to,
                                    const Eigen::RowVector3d& width, const std::vector<JointWeight>& weights,
                                    Character& character) {
  const Eigen::Index count = character.vertices.rows(), triangles = character.triangles.rows();
  character.vertices.conservativeResize(count + 2 * kRows, 3);
  character.triangles.conservativeResize(triangles + 2 * (kRows - 1), 3);
  std::vector<std::uint32_t> added;
  for (int k = 0; k < 2 * kRows; ++k) {
    const double along = (k / 2) / (kRows - 1.0);
    character.vertices.row(count + k) = from + along * (to - from) + (k % 2) * width;
    character.weights.push_back(weights);
    added.push_back(static_cast<std::uint32_t>(count + k));
    character.output_vertex.push_back(added.back());
  }
  for (int k = 0; k + 1 < kRows; ++k) {
    const std::uint32_t a = added[static_cast<std::size_t>(2 * k)];
    character.triangles.row(triangles + 2 * k) << a, a + 1, a + 2;
    character.triangles.row(triangles + 2 * k + 1) << a + 1, a + 3, a + 2;
  }
  character.output_triangles = character.triangles;
  return added;
}

double most_stretched(const Character& character, const Pose& pose, bool draft) {
  const QuasiStaticBody body =
      make_body(character, {}, {.tet_size = 0.05, .threads = 1, .draft = draft, .anatomy = kLimbAnatomy});
  LoosePieceStretch stretch(character, body.riding());
  stretch.add(1, body.skin(body.solve(pose).nodes));
  return stretch.most();
}

// A long card on the elbow, where neighbouring tets turn differently.
TEST(LoosePieces, ACardOnABendMovesAsOnePiece) {
  Character limb = make_limb();
  add_card({0.24, 0, 0.038}, {0.24, 0, 0.3}, {0.02, 0, 0}, {{0, 0.5}, {1, 0.5}}, limb);
  for (const bool draft : {false, true}) EXPECT_LT(most_stretched(limb, bent(limb, degrees(80)), draft), 1.2) << draft;
}

// From the hand of one limb to the side of another, which stays where it is: the card goes with its own joints.
TEST(LoosePieces, ACardNearTwoPartsFollowsItsOwn) {
  Character both = make_two_limbs(0.2);
  const std::size_t half = both.weights.size() / 2;
  for (std::size_t v = half; v < both.weights.size(); ++v) both.weights[v] = {{0, 1.0}};
  both.output_vertex.clear();
  for (std::uint32_t v = 0; v < 2 * half; ++v) both.output_vertex.push_back(v);
  add_card({0.4, 0.04, 0}, {0.4, 0.158, 0}, {0.02, 0, 0}, {{1, 1.0}}, both);
  EXPECT_LT(most_stretched(both, bent(both, degrees(-60)), false), 1.2);
}

TEST(LoosePieces, AtRestTheyAreWhereTheyWere) {
  Character limb = make_limb();
  add_card({0.1, 0, 0.04}, {0.1, 0, 0.2}, {0.02, 0, 0}, {{0, 1.0}}, limb);
  const QuasiStaticBody body = make_body(limb, {}, {.tet_size = 0.05, .threads = 1, .anatomy = kLimbAnatomy});
  ASSERT_EQ(body.riding().size(), 2u * kRows);
  const Positions rest = body.skin(body.solve(bind_pose(limb.skeleton)).nodes);
  EXPECT_LT((rest - limb.vertices).cwiseAbs().maxCoeff(), 1e-6);
}

// By the numbers of the file, which need not be those of the welded skin; slivers, and what does not ride, count not.
TEST(LoosePieces, TheEdgeThatIsStretchedMostIsNamedAsTheFileHasIt) {
  Character limb = make_limb();
  const std::vector<std::uint32_t> card = add_card({0.1, 0, 0.04}, {0.1, 0, 0.2}, {0.02, 0, 0}, {{0, 1.0}}, limb);
  limb.vertices.row(card[1]) = limb.vertices.row(card[0]) + Eigen::RowVector3d(1e-5, 0, 0);  // a sliver
  limb.weights[card.back()] = {{1, 1.0}};
  std::reverse(limb.output_vertex.begin(), limb.output_vertex.end());
  LoosePieceStretch stretch(limb, card);
  Positions skin = limb.vertices;
  skin.row(0) *= 3;                                     // does not ride
  skin.row(card[1]) += Eigen::RowVector3d(1e-4, 0, 0);  // eleven times as long
  stretch.add(1, skin);
  EXPECT_EQ(stretch.warning(), "");
  const std::uint32_t last = card.back(), beside = card[card.size() - 2];
  skin.row(last) += 0.8 * (limb.vertices.row(last) - limb.vertices.row(beside));
  stretch.add(7, skin);
  skin.row(last) = limb.vertices.row(last);
  stretch.add(8, skin);
  EXPECT_NEAR(stretch.most(), 1.8, 1e-9);
  const std::string said = stretch.warning();
  EXPECT_NE(said.find("1.8 times its length in frame 7"), std::string::npos) << said;
  EXPECT_NE(said.find(" 0 ('lower')"), std::string::npos) << said;
  EXPECT_NE(said.find(" 1 ('upper')"), std::string::npos) << said;
}

// A card whose two halves follow different joints.
TEST(LoosePieces, WhatIsStretchedIsSaidWithItsPlace) {
  const TemporaryFolder folder;
  Character limb = make_limb();
  const std::vector<std::uint32_t> card = add_card({0.24, -0.038, 0}, {0.24, -0.2, 0}, {0.02, 0, 0}, {{0, 1.0}}, limb);
  Clip clip;
  clip.name = "bend";
  clip.first_frame = 1;
  clip.poses = {bent(limb, 0), bent(limb, degrees(80))};
  const auto warned = [&] {
    std::string text;
    SimulateOptions options{.tet_size = 0.05, .threads = 1, .anatomy = kLimbAnatomy};
    options.warn = [&](const std::string& warning) { text += warning; };
    simulate_one_take(limb, {}, clip, {1, 2}, folder / "take.pc2", folder / "take.json", options);
    return text;
  };
  EXPECT_EQ(warned().find("stretched"), std::string::npos);
  for (std::size_t k = 1; k < card.size(); k += 2) limb.weights[card[k]] = {{1, 1.0}};
  const std::string said = warned();
  EXPECT_NE(said.find("is stretched to"), std::string::npos) << said;
  EXPECT_NE(said.find("in frame 2"), std::string::npos) << said;
  EXPECT_NE(said.find("'upper'"), std::string::npos) << said;
}

}  // namespace
}  // namespace bodyopt::trainer
