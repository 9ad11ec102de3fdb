// What brushes do, on surfaces of which that is known.
#include <gtest/gtest.h>

#include <cmath>

#include "geometry/brush.h"
#include "tests/geometry/sheet.h"

namespace bodyopt {
namespace {

constexpr BrushKind kAll[] = {BrushKind::grab, BrushKind::smooth, BrushKind::inflate, BrushKind::flatten,
                              BrushKind::erase};

// Waves, so that there is something to smooth; alike on both sides of x = 0.
Sheet wavy_sheet() {
  Sheet sheet = flat_sheet(25);
  for (Eigen::Index v = 0; v < sheet.vertices.rows(); ++v) {
    sheet.vertices(v, 2) =
        0.05 * std::cos(9 * sheet.vertices(v, 0)) * std::sin(7 * sheet.vertices(v, 1)) + 0.03 * (v % 2 == 0 ? 1 : -1);
  }
  return sheet;
}

Positions stroked(const Sheet& sheet, const Positions& erased, const Brush& brush, const std::vector<SkinPoint>& hands,
                  const std::vector<Eigen::Vector3d>& ways, int touches = 1) {
  const SurfaceDistance paths(sheet.vertices.rows(), sheet.triangles);
  BrushStroke stroke(paths, sheet.triangles, sheet.vertices, erased, brush);
  for (int k = 0; k < touches; ++k) stroke.touch(hands);
  stroke.pull(ways);
  return stroke.surface();
}

Positions lifted(const Sheet& sheet) { return sheet.vertices.rowwise() + Eigen::RowVector3d(0, 0, 0.2); }

TEST(BrushStroke, OfNoRadiusOrNoStrengthMovesNothing) {
  const Sheet sheet = wavy_sheet();
  for (const BrushKind kind : kAll) {
    for (const Brush& brush : {Brush{kind, 0, 1}, Brush{kind, 0.3, 0}}) {
      const SkinPoint at = point_of(sheet, 500, {1, 0, 0});
      EXPECT_EQ(stroked(sheet, lifted(sheet), brush, {at}, {{0.1, 0, 0.1}}), sheet.vertices);
    }
  }
}

TEST(BrushStroke, MovesTheSkinWithinItsRadiusAlone) {
  const Sheet sheet = wavy_sheet();
  const SurfaceDistance paths(sheet.vertices.rows(), sheet.triangles);
  const SkinPoint at = point_of(sheet, 500, {0.2, 0.3, 0.5});
  std::vector<char> near(static_cast<std::size_t>(sheet.vertices.rows()), false);
  for (const SurfacePlace& place : paths.around(sheet.vertices, at, 0.3)) near[place.vertex] = true;
  for (const BrushKind kind : kAll) {
    const Positions after = stroked(sheet, lifted(sheet), {kind, 0.3, 1}, {at}, {{0.1, 0, 0.1}});
    double most = 0;
    for (Eigen::Index v = 0; v < after.rows(); ++v) {
      const double moved = (after.row(v) - sheet.vertices.row(v)).norm();
      most = std::max(most, moved);
      if (!near[static_cast<std::size_t>(v)]) {
        EXPECT_EQ(moved, 0);
      }
    }
    EXPECT_GT(most, 1e-3) << kBrushKindNames[static_cast<std::size_t>(kind)];
  }
}

TEST(BrushStroke, AGrabbedPointFollowsTheHandAndComesBackWithIt) {
  const Sheet sheet = wavy_sheet();
  const SkinPoint at = point_of(sheet, 500, {1, 0, 0});
  const SurfaceDistance paths(sheet.vertices.rows(), sheet.triangles);
  BrushStroke stroke(paths, sheet.triangles, sheet.vertices, sheet.vertices, {BrushKind::grab, 0.3, 1});
  stroke.touch(std::vector{at});
  const Eigen::Vector3d way(0.1, -0.05, 0.2);
  stroke.pull(std::vector{way});
  EXPECT_LT((stroke.surface().row(at.vertices[0]).transpose() - at.position - way).norm(), 1e-12);
  stroke.pull(std::vector<Eigen::Vector3d>{Eigen::Vector3d::Zero()});
  EXPECT_EQ(stroke.surface(), sheet.vertices);
}

TEST(BrushStroke, SmoothAndFlattenLeaveAPlaneAlone) {
  Sheet sheet = flat_sheet(25);
  sheet.vertices.col(0).array() += 0.02 * (9 * sheet.vertices.col(1).array()).sin();  // of no regular triangles
  for (const BrushKind kind : {BrushKind::smooth, BrushKind::flatten}) {
    const SkinPoint at = point_of(sheet, 500, {0.2, 0.3, 0.5});
    const Positions after = stroked(sheet, sheet.vertices, {kind, 0.4, 1}, {at}, {}, 5);
    EXPECT_LT((after - sheet.vertices).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(BrushStroke, SmoothTakesAwayWhatIsRoughAndFlattenWhatStandsOut) {
  const Sheet sheet = wavy_sheet();
  const SkinPoint at = point_of(sheet, 550, {1, 0, 0});
  const SurfaceDistance paths(sheet.vertices.rows(), sheet.triangles);
  const auto height = [&](const Positions& surface) {
    double sum = 0, squared = 0;
    int count = 0;
    for (const SurfacePlace& place : paths.around(sheet.vertices, at, 0.15)) {
      const double z = surface(place.vertex, 2);
      sum += z;
      squared += z * z;
      ++count;
    }
    return std::sqrt(squared / count - sum * sum / (count * count));
  };
  for (const BrushKind kind : {BrushKind::smooth, BrushKind::flatten}) {
    const Positions after = stroked(sheet, sheet.vertices, {kind, 0.5, 1}, {at}, {}, 20);
    EXPECT_LT(height(after), 0.5 * height(sheet.vertices)) << kBrushKindNames[static_cast<std::size_t>(kind)];
  }
}

TEST(BrushStroke, InflateGoesAlongTheNormals) {
  const Sheet sheet = flat_sheet(25);
  const SkinPoint at = point_of(sheet, 500, {1, 0, 0});
  const Positions after = stroked(sheet, sheet.vertices, {BrushKind::inflate, 0.4, 0.5}, {at}, {});
  EXPECT_EQ(after.leftCols<2>(), sheet.vertices.leftCols<2>());
  EXPECT_NEAR(after(at.vertices[0], 2), 0.5 * 0.05 * 0.4, 1e-12) << "5 % of the radius, half as strong";
  EXPECT_GE(after.col(2).minCoeff(), 0);
}

TEST(BrushStroke, EraseGivesTheSurfaceBack) {
  const Sheet sheet = wavy_sheet();
  const SkinPoint at = point_of(sheet, 500, {0.2, 0.3, 0.5});
  Sheet made = sheet;
  made.vertices = stroked(sheet, sheet.vertices, {BrushKind::grab, 0.3, 1}, {at}, {{0.05, 0, 0.15}});
  ASSERT_GT((made.vertices - sheet.vertices).norm(), 0.1);
  const SkinPoint there = point_of(made, 500, {0.2, 0.3, 0.5});
  const Positions after = stroked(made, sheet.vertices, {BrushKind::erase, 0.9, 1}, {there}, {}, 60);
  EXPECT_LT((after - sheet.vertices).cwiseAbs().maxCoeff(), 1e-9);
}

// Also where both hands hold the same skin.
TEST(BrushStroke, OfTwoHandsIsAsInAMirror) {
  const Sheet sheet = wavy_sheet();
  const int side = 25, at = 12 * side + 9, mirrored = 12 * side + 15;
  const auto vertex = [&](int v) {
    for (Eigen::Index t = 0; t < sheet.triangles.rows(); ++t) {
      if (sheet.triangles(t, 0) == static_cast<std::uint32_t>(v)) return point_of(sheet, t, {1, 0, 0});
    }
    return SkinPoint{};
  };
  for (const BrushKind kind : kAll) {
    const Positions after = stroked(sheet, lifted(sheet), {kind, 0.5, 0.7}, {vertex(at), vertex(mirrored)},
                                    {{0.1, 0.02, 0.2}, {-0.1, 0.02, 0.2}});
    ASSERT_GT((after - sheet.vertices).norm(), 1e-3);
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const Eigen::RowVector3d own = after.row(y * side + x), other = after.row(y * side + side - 1 - x);
        EXPECT_LT((own - Eigen::RowVector3d(-other.x(), other.y(), other.z())).norm(), 1e-9);
      }
    }
  }
}

// As the ear or the hand: near through the air, far along the skin.
TEST(BrushStroke, TheFarSideOfAThinPartStaysWhereItIs) {
  const int side = 25;
  Sheet folded = flat_sheet(side);
  for (Eigen::Index v = 0; v < folded.vertices.rows(); ++v) {
    const double x = folded.vertices(v, 0);
    folded.vertices.row(v) << std::abs(x), folded.vertices(v, 1), x < 0 ? 0.01 : 0;
  }
  const SkinPoint at = point_of(folded, 2 * (12 * (side - 1) + 18), {1, 0, 0});
  ASSERT_GT(at.position.x(), 0.4);
  for (const BrushKind kind : {BrushKind::grab, BrushKind::inflate}) {
    const Positions after = stroked(folded, folded.vertices, {kind, 0.4, 1}, {at}, {{0, 0, 0.3}});
    for (int v = 0; v < side * side; ++v) {
      const bool far = v % side < side / 2;
      if (far) {
        EXPECT_EQ(after.row(v), folded.vertices.row(v));
      }
    }
    EXPECT_GT((after - folded.vertices).norm(), 1e-3);
  }
}

}  // namespace
}  // namespace bodyopt
