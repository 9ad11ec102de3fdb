// Deformation transfer against a dense least-squares problem, and where its result is known.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "geometry/mesh.h"
#include "geometry/surface_distance.h"
#include "tests/support/textbook_algebra.h"
#include "trainer/transfer/skin_transfer.h"

namespace bodyopt::trainer {
namespace {

struct Tube {
  Positions vertices;
  Triangles triangles;
};

// Rings of 10 vertices around x, and bumps: 500 triangles of 26 rings.
Tube tube(double radius, double length, int rings) {
  constexpr int kAround = 10;
  Tube result{Positions(rings * kAround, 3), Triangles(2 * (rings - 1) * kAround, 3)};
  for (int r = 0; r < rings; ++r) {
    for (int k = 0; k < kAround; ++k) {
      const double angle = 2 * M_PI * k / kAround, along = length * r / (rings - 1);
      const double wide = radius * (1 + 0.3 * std::sin(5 * along / length + k));
      result.vertices.row(r * kAround + k) << along, wide * std::cos(angle), wide * std::sin(angle);
    }
  }
  Eigen::Index t = 0;
  for (int r = 0; r + 1 < rings; ++r) {
    for (int k = 0; k < kAround; ++k) {
      const auto at = [&](int ring, int place) { return static_cast<std::uint32_t>(ring * kAround + place % kAround); };
      result.triangles.row(t++) << at(r, k), at(r, k + 1), at(r + 1, k);
      result.triangles.row(t++) << at(r, k + 1), at(r + 1, k + 1), at(r + 1, k);
    }
  }
  return result;
}

Positions random_displacements(Eigen::Index count) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0, 0.01);
  Positions result(count, 3);
  for (Eigen::Index k = 0; k < result.size(); ++k) result.data()[k] = normal(random);
  return result;
}

// The displacement gradient of a triangle by its edges and its normal alone: D [e1 e2 n] = [d1 d2 -(D^T n)], where the
// normal turns as -(D^T n) does.
Eigen::Matrix3d gradient_of(const Positions& vertices, const Eigen::RowVector3<std::uint32_t>& corners,
                            const Positions& displacements) {
  Eigen::Matrix3d edges, moved;
  for (int k = 0; k < 2; ++k) {
    edges.col(k) = (vertices.row(corners[k + 1]) - vertices.row(corners[0])).transpose();
    moved.col(k) = (displacements.row(corners[k + 1]) - displacements.row(corners[0])).transpose();
  }
  edges.col(2) = edges.col(0).cross(edges.col(1)).normalized();
  moved.col(2).setZero();
  const Eigen::Matrix3d inside = moved * edges.inverse();
  return inside - inside.transpose() * edges.col(2) * edges.col(2).transpose();
}

}  // namespace

TEST(DeformationTransfer, EqualsADenseLeastSquaresProblem) {
  const Tube source = tube(0.1, 1, 26), target = tube(0.17, 1.3, 26);
  ASSERT_EQ(source.triangles.rows(), 500);
  const Positions displacements = random_displacements(source.vertices.rows());
  const DeformationTransfer transfer(source.vertices, target.vertices, source.triangles, TransferSize::source);
  const Positions result = transfer(displacements);

  // Unknowns: a row of displacements per vertex. Two rows an axis and triangle: the changes along its edges' axes.
  const Eigen::Index count = source.vertices.rows(), triangles = source.triangles.rows();
  const Eigen::VectorXd source_areas = lumped_areas(source.vertices, source.triangles),
                        areas = lumped_areas(target.vertices, source.triangles);
  const double reach = 0.1 * longest_extent(target.vertices);
  const Eigen::VectorXd sizes =
      smoothed(target.vertices, source.triangles, (areas.array() / source_areas.array()).sqrt(), 0.1 * reach);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(2 * triangles + count, count);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(2 * triangles + count, 3);
  for (Eigen::Index t = 0; t < triangles; ++t) {
    const auto corners = source.triangles.row(t);
    Eigen::Matrix<double, 3, 2> edges;
    for (int k = 0; k < 2; ++k) {
      edges.col(k) = (target.vertices.row(corners[k + 1]) - target.vertices.row(corners[0])).transpose();
    }
    const Eigen::Vector3d u = edges.col(0).normalized(), v = (edges.col(1) - u * u.dot(edges.col(1))).normalized();
    Eigen::Matrix2d flat;  // edges in the axes u, v
    flat << u.dot(edges.col(0)), u.dot(edges.col(1)), v.dot(edges.col(0)), v.dot(edges.col(1));
    const Eigen::Matrix2d inverse = flat.inverse();
    const double root = std::sqrt(0.5 * std::abs(flat.determinant()));
    const double size = (sizes[corners[0]] + sizes[corners[1]] + sizes[corners[2]]) / 3;
    const Eigen::Matrix3d wanted = gradient_of(source.vertices, corners, displacements) / size;
    for (int axis = 0; axis < 2; ++axis) {
      for (int k = 0; k < 2; ++k) {
        matrix(2 * t + axis, corners[k + 1]) += root * inverse(k, axis);
        matrix(2 * t + axis, corners[0]) -= root * inverse(k, axis);
      }
      right.row(2 * t + axis) = root * (wanted * (axis == 0 ? u : v)).transpose();
    }
  }
  for (Eigen::Index v = 0; v < count; ++v) {
    const double root = std::sqrt(areas[v]) / reach;
    matrix(2 * triangles + v, v) = root;
    right.row(2 * triangles + v) = root * displacements.row(v);
  }
  const Eigen::MatrixXd reference = testing::textbook_solve(matrix, right);
  EXPECT_LT((result - reference).cwiseAbs().maxCoeff(), 1e-8 * reference.cwiseAbs().maxCoeff());
}

TEST(DeformationTransfer, OfTheSameSkinChangesNothing) {
  const Tube body = tube(0.1, 1, 26);
  const DeformationTransfer transfer(body.vertices, body.vertices, body.triangles, TransferSize::local);
  const Positions displacements = random_displacements(body.vertices.rows());
  EXPECT_LT((transfer(displacements) - displacements).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(DeformationTransfer, ScalesWithTheTarget) {
  const Tube body = tube(0.1, 1, 26);
  const Positions displacements = random_displacements(body.vertices.rows());
  const Positions larger = 2.5 * body.vertices;
  const DeformationTransfer local(body.vertices, larger, body.triangles, TransferSize::local),
      metres(body.vertices, larger, body.triangles, TransferSize::source);
  EXPECT_LT((local(displacements) - 2.5 * displacements).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_LT((metres(displacements) - displacements).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(DeformationTransfer, StretchesNothingThatOnlyMoves) {
  const Tube source = tube(0.1, 1, 26), target = tube(0.17, 1, 26);
  const DeformationTransfer transfer(source.vertices, target.vertices, source.triangles, TransferSize::source);
  const Positions shift = Eigen::RowVector3d(0.01, -0.02, 0.03).replicate(source.vertices.rows(), 1);
  EXPECT_LT((transfer(shift) - shift).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(DeformationTransfer, ThinLimbsGetThinBulges) {
  const Tube source = tube(0.1, 1, 26);
  Positions thin = source.vertices;
  thin.rightCols<2>() *= 0.5;
  Positions bulge = 0.2 * source.vertices;  // by a fifth of the radius
  bulge.col(0).setZero();
  const Positions result = DeformationTransfer(source.vertices, thin, source.triangles, TransferSize::local)(bulge);
  // Half the radius, half the bulge, but for what the ends and the anchors pull.
  const Positions wanted = 0.5 * bulge;
  EXPECT_LT((result - wanted).norm(), 0.25 * wanted.norm());
  EXPECT_GT(result.rightCols<2>().norm(), 0.75 * wanted.norm());
}

}  // namespace bodyopt::trainer
