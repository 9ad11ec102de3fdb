#include "trainer/transfer/register_skin.h"

#include <cmath>

#include "base/linear_algebra.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "geometry/extent.h"
#include "geometry/laplacian.h"
#include "geometry/table_rows.h"
#include "geometry/vertex_normals.h"
#include "trainer/transfer/joint_warp.h"

namespace bodyopt {
namespace {

// Lengths over which the membrane carries a pull, of the target's extent, from coarse to fine; each in some rounds.
constexpr double kStiffness[] = {0.2, 0.1, 0.05, 0.025, 0.012, 0.006, 0.003};
constexpr int kRounds = 4;
constexpr double kMarkerPull = 100;  // vertices that a marker counts as

class NonRigidFit {
 public:
  NonRigidFit(const Basis& source, const Basis& target, const Positions& goal, const JointShares& source_shares,
              const JointShares& target_shares, Positions start)
      : triangles_(rows_of(source.mesh.triangles)),
        goal_triangles_(rows_of(target.mesh.triangles)),
        goal_(goal),
        source_shares_(source_shares),
        target_shares_(target_shares),
        start_(std::move(start)),
        fitted_(start_),
        membrane_(cotangent_laplacian(start_, triangles_)),
        areas_(lumped_areas(start_, triangles_)),
        goal_normals_(vertex_normals(goal, goal_triangles_)),
        nearest_(goal_, goal_triangles_),
        extent_(longest_extent(goal)),
        pulls_(Eigen::VectorXd::Zero(start_.rows())),
        places_(start_) {}

  void set_marker(std::uint32_t vertex, const Eigen::RowVector3d& place) { markers_.emplace_back(vertex, place); }

  Positions fit() {
    Progress progress("transfer: fitting the skins", std::size(kStiffness) * kRounds);
    for (const double stiffness : kStiffness) {
      for (int round = 0; round < kRounds; ++round) {
        find_places();
        pull(std::pow(stiffness * extent_, 2));
        progress.advance();
      }
    }
    return fitted_;
  }

 private:
  // The nearest point of the goal for each vertex, and how much it is to be believed.
  void find_places() {
    const Positions normals = vertex_normals(fitted_, triangles_);
    parallel_for(static_cast<std::size_t>(fitted_.rows()), [&](std::size_t v) {
      const auto row = static_cast<Eigen::Index>(v);
      const Eigen::Vector3d normal = normals.row(row).normalized();
      const SkinPoint point = nearest_.facing(fitted_.row(row), normal);
      pulls_[row] = 0;
      if (point.triangle < 0) return;
      Eigen::RowVectorXd shares = Eigen::RowVectorXd::Zero(source_shares_.cols());
      Eigen::Vector3d other = Eigen::Vector3d::Zero();
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t corner = point.vertices[static_cast<std::size_t>(k)];
        shares += point.weights[k] * target_shares_.row(corner);
        other += point.weights[k] * goal_normals_.row(corner).normalized().transpose();
      }
      const double alike = shares.cwiseMin(source_shares_.row(row)).sum();
      pulls_[row] = areas_[row] * std::pow(std::max(0.0, normal.dot(other)), 2) * alike * alike;
      places_.row(row) = point.position.transpose();
    });
    for (const auto& [vertex, place] : markers_) {
      pulls_[vertex] = kMarkerPull * areas_.mean();
      places_.row(vertex) = place;
    }
  }

  // Least: stiffness x membrane of what has moved from the start, and the pulls.
  void pull(double stiffness) {
    Eigen::SparseMatrix<double> matrix = stiffness * membrane_;
    matrix.diagonal() += pulls_ + 1e-6 * areas_;
    const SparseSolver solver(matrix);
    const Eigen::MatrixXd right = pulls_.asDiagonal() * (places_ - start_);
    fitted_ = start_ + Positions(solver.solve(right));
  }

  const Triangles triangles_, goal_triangles_;
  const Positions& goal_;
  const JointShares &source_shares_, &target_shares_;
  const Positions start_;
  Positions fitted_;
  const Eigen::SparseMatrix<double> membrane_;
  const Eigen::VectorXd areas_;
  const Positions goal_normals_;
  const NearestSkin nearest_;
  const double extent_;
  Eigen::VectorXd pulls_;
  Positions places_;
  std::vector<std::pair<std::uint32_t, Eigen::RowVector3d>> markers_;  // source vertices, where they are to be
};

}  // namespace

Positions register_skin(const Basis& source, const Basis& target, const Positions& goal,
                        const JointShares& source_shares, const JointShares& target_shares, const SkeletonMatch& match,
                        const std::vector<SkinMarker>& markers) {
  NonRigidFit fit(source, target, goal, source_shares, target_shares, warped_by_joints(source, target, match));
  for (const SkinMarker& marker : markers) {
    fit.set_marker(source.mesh.output_vertex[marker.source], goal.row(target.mesh.output_vertex[marker.target]));
  }
  return fit.fit();
}

}  // namespace bodyopt
