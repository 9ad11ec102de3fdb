// Smooth filling where its result is known, and what is carried where a match is unsure.
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "geometry/mesh.h"
#include "geometry/surface_distance.h"
#include "tests/support/textbook_algebra.h"
#include "tests/transfer/refined_limb.h"
#include "trainer/train/skinning/ddm.h"
#include "trainer/transfer/carry_parts.h"
#include "trainer/transfer/skin_transfer.h"
#include "trainer/transfer/transfer_pair.h"

namespace bodyopt::trainer {
namespace {

constexpr int kSide = 9;

// A flat grid of unequal steps, and a triangle beside it.
struct Sheet {
  Positions vertices{kSide * kSide + 3, 3};
  Triangles triangles{2 * (kSide - 1) * (kSide - 1) + 1, 3};

  Sheet() {
    Eigen::Index t = 0;
    for (int i = 0; i < kSide; ++i) {
      for (int k = 0; k < kSide; ++k) {
        vertices.row(kSide * i + k) << 0.1 * i + 0.01 * i * i, 0.1 * k + 0.02 * k * k, 0;
        if (i + 1 == kSide || k + 1 == kSide) continue;
        const auto at = static_cast<std::uint32_t>(kSide * i + k);
        triangles.row(t++) << at, at + kSide, at + 1;
        triangles.row(t++) << at + 1, at + kSide, at + kSide + 1;
      }
    }
    vertices.bottomRows(3) << 5, 0, 0, 6, 0, 0, 5, 1, 0;
    triangles.row(t) << kSide * kSide, kSide * kSide + 1, kSide * kSide + 2;
  }
};

// The limb in finer triangles, some of whose skin is held by a joint that is far away.
Character oddly_held_limb() {
  Character limb = refined_limb();
  for (Eigen::Index v = 0; v < limb.vertices.rows(); ++v) {
    const auto at = limb.vertices.row(v);
    if (at.x() > 0 && at.z() > 0.06 && at.z() < 0.18) limb.weights[static_cast<std::size_t>(v)] = {{2, 1}};
  }
  return limb;
}

class UnsureLimb : public ::testing::Test {
 protected:
  const Basis source_ = build_ddm_basis(limb_character(), {});
  TransferPair pair_{source_, oddly_held_limb(), {}};
};

// A linear function of the plane is harmonic, whatever the steps of the grid.
TEST(SmoothFill, ALinearFunctionIsFilledInExactly) {
  const Sheet sheet;
  std::vector<int> unknown;
  for (int i = 2; i < kSide - 1; ++i) {
    for (int k = 1; k < kSide - 2; ++k) unknown.push_back(kSide * i + k);
  }
  Eigen::MatrixXd wanted(sheet.vertices.rows(), 2);
  wanted.col(0) = 2 * sheet.vertices.col(0) - 3 * sheet.vertices.col(1);
  wanted.col(1) = sheet.vertices.col(1).array() + 1;
  Eigen::MatrixXd values = wanted;
  for (const int v : unknown) values.row(v) << 1, -1;
  SmoothFill(sheet.vertices, sheet.triangles, unknown)(values);
  EXPECT_LT((values - wanted).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(SmoothFill, APieceOfItsOwnTakesItsMean) {
  const Sheet sheet;
  Eigen::MatrixXd values = Eigen::MatrixXd::Random(sheet.vertices.rows(), 1);
  const Eigen::MatrixXd before = values;
  const int first = kSide * kSide;
  SmoothFill(sheet.vertices, sheet.triangles, {0, first, first + 1, first + 2})(values);
  EXPECT_LT((values.bottomRows(3).array() - before.bottomRows(3).mean()).abs().maxCoeff(), 1e-5);
  EXPECT_NE(values(0), before(0));
}

TEST(SmoothFill, RowsBelow) {
  EXPECT_EQ(rows_below(Eigen::Vector4d(0.3, 0.4, 0.1, 0.5), 0.4), (std::vector<int>{0, 2}));
}

// By a dense solve of the Laplace equation between the weights where it is sure.
TEST_F(UnsureLimb, RegionsAreHarmonicWhereTheMatchIsUnsure) {
  RegionWeights low{"low", {}, {}}, high{"high", {}, {}};
  for (std::uint32_t v = 0; v < source_.mesh.vertex_count(); ++v) {
    const double share = std::clamp((double{source_.mesh.rest[3 * v + 2]} - 0.1) / 0.03, 0.0, 1.0);
    for (const auto& [region, weight] : {std::pair{&low, 1 - share}, {&high, share}}) {
      if (!(weight > 0)) continue;
      region->vertices.push_back(v);
      region->weights.push_back(weight);
    }
  }
  const std::vector<RegionWeights> carried = carried_regions(pair_, {low, high});
  ASSERT_EQ(carried.size(), 2u);
  const Eigen::Index count = pair_.correspondence.target.rows();
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(count, 2);
  for (Eigen::Index r = 0; r < 2; ++r) {
    const RegionWeights& region = carried[static_cast<std::size_t>(r)];
    for (std::size_t k = 0; k < region.vertices.size(); ++k) weights(region.vertices[k], r) = region.weights[k];
  }
  EXPECT_LT((weights.rowwise().sum().array() - 1).abs().maxCoeff(), 2 * kNegligibleRegionWeight);

  std::vector<int> unsure, sure;
  for (int v = 0; v < count; ++v) {
    (pair_.correspondence.confidence[v] < kSureConfidence ? unsure : sure).push_back(v);
  }
  ASSERT_GT(unsure.size(), 20u);
  ASSERT_LT(unsure.size(), sure.size());
  const Eigen::MatrixXd laplacian =
      cotangent_laplacian(pair_.correspondence.target, rows_of(pair_.target.mesh.triangles));
  const Eigen::MatrixXd wanted =
      testing::textbook_solve(laplacian(unsure, unsure), -laplacian(unsure, sure) * weights(sure, Eigen::all));
  const Eigen::MatrixXd found = weights(unsure, Eigen::all);
  // Negligible weights are dropped, on either side of the edge.
  EXPECT_LT((found - wanted).cwiseAbs().maxCoeff(), kNegligibleRegionWeight);
  EXPECT_GT((found.array() > 0.05 && found.array() < 0.95).count(), 10);
}

// Wherever the fit has gone there, it is the same limb.
TEST_F(UnsureLimb, UnsureSkinLiesAmongWhatIsSureAroundIt) {
  const Eigen::VectorXd confidence = source_confidence(pair_.correspondence, rows_of(pair_.target.mesh.triangles));
  const std::vector<int> unsure = rows_below(confidence, kSureConfidence);
  ASSERT_GT(unsure.size(), 5u);
  const Positions rest = rows_of(source_.mesh.rest), found = sure_places(pair_);
  Positions off = found - rest;
  EXPECT_LT(off.rowwise().norm().maxCoeff(), 2e-3);
  for (Eigen::Index v = 0; v < rest.rows(); ++v) {
    if (confidence[v] < kSureConfidence) continue;
    EXPECT_EQ(found.row(v), pair_.correspondence.fitted.row(v));
  }
}

}  // namespace
}  // namespace bodyopt::trainer
