#include "trainer/anatomy/section.h"

#include <gtest/gtest.h>

#include <numbers>

#include "trainer/anatomy/anatomy_report.h"

namespace bodyopt::trainer {
namespace {

// A bone of 2 cm in a muscle of 4 cm in fat of 5 cm, all balls about the origin.
TissueAt tissue_of_balls(const Eigen::Vector3d& point) {
  const double r = point.norm();
  if (r < 0.02) return {TissueKind::bone, 3, -1};
  if (r < 0.04) return {TissueKind::muscle, -1, 0};
  return {r < 0.05 ? TissueKind::fat : TissueKind::outside, -1, -1};
}

double area_of(const TissueSection& section, TissueKind kind, double pixel) {
  const auto of_kind = [&](const TissueAt& tissue) { return tissue.kind == kind; };
  return pixel * pixel * static_cast<double>(std::ranges::count_if(section.tissue, of_kind));
}

TEST(Section, HasTheAreasOfWhatItCuts) {
  const Eigen::Vector3d right = Eigen::Vector3d(1, 2, -1).normalized();
  const Eigen::Vector3d down = right.cross(Eigen::Vector3d::UnitY()).normalized();
  const auto everywhere = [](const SectionPlane& plane) {
    RestPoints points;
    for (int pixel = 0; pixel < plane.size(); ++pixel) {
      const Eigen::Vector3d at = plane.middle(pixel);
      points.push_back(at.norm() < 0.05 ? std::optional(RestPoint{at}) : std::nullopt);
    }
    return points;
  };
  for (const double offset : {0.0, 0.012, 0.03}) {
    const SectionPlane plane = plane_around(offset * right.cross(down), right, down, {0.12, 0.11}, 5e-4);
    EXPECT_EQ(plane.width, 240);
    EXPECT_EQ(plane.height, 220);
    const TissueSection section = section_of(plane, everywhere(plane), tissue_of_balls);
    const auto disc = [&](double r) { return std::numbers::pi * std::max(0.0, r * r - offset * offset); };
    EXPECT_NEAR(area_of(section, TissueKind::bone, plane.pixel), disc(0.02), 4e-5);
    EXPECT_NEAR(area_of(section, TissueKind::muscle, plane.pixel), disc(0.04) - disc(0.02), 4e-5);
    EXPECT_NEAR(area_of(section, TissueKind::fat, plane.pixel), disc(0.05) - disc(0.04), 4e-5);
  }
}

// Two tets, stretched and turned: what lies at a pixel at rest is what the inverse of that says.
TEST(Section, GoesBackWithTheTetsThatMoved) {
  TetMesh rest;
  rest.nodes.resize(5, 3);
  rest.nodes << 0, 0, 0, 0.1, 0, 0, 0, 0.1, 0, 0, 0, 0.1, 0.1, 0.1, 0.1;
  rest.tets.resize(2, 4);
  rest.tets << 0, 1, 2, 3, 1, 2, 3, 4;
  orient(rest);
  const Eigen::Affine3d move = Eigen::Translation3d(1, 2, 3) *
                               Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 1, 0).normalized()) *
                               Eigen::Scaling(1.0, 1.5, 0.8);
  Positions moved(6, 3);  // the last carries what rides, and is no corner
  for (Eigen::Index n = 0; n < 5; ++n) moved.row(n) = (move * rest.nodes.row(n).transpose()).transpose();
  moved.row(5).setConstant(1e9);
  const Eigen::Vector3d middle = move * Eigen::Vector3d(0.04, 0.04, 0.04);
  const SectionPlane plane = plane_around(middle, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ(), {0.3, 0.3}, 3e-3);
  const auto everything = [](const Eigen::Vector3d&) { return true; };
  const RestPoints points = rest_points(plane, rest, moved, everything);
  int inside = 0;
  for (int pixel = 0; pixel < plane.size(); ++pixel) {
    const Eigen::Vector3d at_rest = move.inverse() * plane.middle(pixel);
    const bool in_first = at_rest.minCoeff() > 1e-6 && at_rest.sum() < 0.1 - 1e-6;
    const auto& point = points[static_cast<std::size_t>(pixel)];
    EXPECT_TRUE(!in_first || (point && point->tet == 0)) << pixel;
    if (!point) continue;
    ++inside;
    EXPECT_LT((point->position - at_rest).norm(), 1e-9);
  }
  EXPECT_GT(inside, 100);
  // Of two tets in one place that counts whose point is tissue.
  TetMesh twice;
  twice.nodes.resize(8, 3);
  twice.nodes << rest.nodes.topRows(4), rest.nodes.topRows(4).rowwise() + Eigen::RowVector3d(1, 0, 0);
  twice.tets.resize(2, 4);
  twice.tets << 0, 1, 2, 3, 4, 5, 6, 7;
  orient(twice);
  Positions together(8, 3);
  together << rest.nodes.topRows(4), rest.nodes.topRows(4);
  const SectionPlane through =
      plane_around({0.03, 0.03, 0.03}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), {0.1, 0.1}, 1e-3);
  for (const Eigen::Index wanted : {0, 1}) {
    const auto is_tissue = [&](const Eigen::Vector3d& point) { return (point.x() > 0.5) == (wanted == 1); };
    for (const auto& point : rest_points(through, twice, together, is_tissue)) {
      EXPECT_TRUE(!point || point->tet == wanted);
    }
  }
}

Muscle named(const std::string& name) {
  Muscle muscle;
  muscle.name = name;
  return muscle;
}

TEST(Section, MusclesHaveColoursOfTheirOwnAndBordersBetweenThem) {
  const TissueColours colours({named("biceps_l"), named("triceps_l"), named("biceps_r")});
  const TissueAt biceps{TissueKind::muscle, -1, 0}, triceps{TissueKind::muscle, -1, 1},
      other{TissueKind::muscle, -1, 2};
  EXPECT_NE(colours.of(biceps), colours.of(triceps));
  EXPECT_EQ(colours.of(biceps), colours.of(other));  // of the other side
  const TissueSection section{4, 1, {biceps, biceps, triceps, {}}};
  const std::vector<std::uint8_t> picture = colours.picture(section);
  ASSERT_EQ(picture.size(), 16u);
  EXPECT_EQ((Rgb{picture[0], picture[1], picture[2]}), colours.of(biceps));
  EXPECT_LT(picture[4], picture[0] / 2 + 1);  // the border
  EXPECT_EQ(picture[11], 255);
  EXPECT_EQ(picture[15], 0);
  // Shortened by a third: orange; as long as at rest: its own.
  const std::vector<double> stretch{2.0 / 3, 1, 1, 1};
  const std::vector<std::uint8_t> strained = colours.picture(section, stretch);
  EXPECT_GT(strained[1], picture[1] + 40);
  EXPECT_EQ(strained[4], picture[4]);
}

}  // namespace
}  // namespace bodyopt::trainer
