#include "trainer/transfer/correspondence.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/linear_algebra.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "geometry/mesh.h"
#include "geometry/surface_distance.h"
#include "runtime/core/error.h"
#include "runtime/cpu/ddm_frames.h"
#include "runtime/host/rig.h"
#include "trainer/transfer/skin_transfer.h"

namespace bodyopt::trainer {
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

// V x 3, runtime order of the source. `goal`: the target's skin in the common pose, runtime order. See match_skins().
// Shows progress; throws Error(interrupted) after SIGINT.
Positions register_skin(const Basis& source, const Basis& target, const Positions& goal,
                        const JointShares& source_shares, const JointShares& target_shares, const SkeletonMatch& match,
                        const std::vector<SkinMarker>& markers) {
  NonRigidFit fit(source, target, goal, source_shares, target_shares, warped_by_joints(source, target, match));
  for (const SkinMarker& marker : markers) {
    fit.set_marker(source.mesh.output_vertex[marker.source], goal.row(target.mesh.output_vertex[marker.target]));
  }
  return fit.fit();
}

constexpr double kNear = 0.015;  // of the target's extent: further from the fitted source, a point is unsure

// The target's rest skin in the common pose, and how it is turned there.
void pose_target(const Basis& target, const SkeletonMatch& match, Correspondence& result) {
  const std::uint32_t count = target.mesh.vertex_count();
  result.target = rows_of(target.mesh.rest);
  result.rotation.assign(count, {0, 0, 0, 1});
  if (!match.is_aligned()) return;
  const RigFrame rig = pose_rig(target.skeleton, match.common);
  const std::vector<float> frames = cpu::vertex_frames(target.ddm, count, rig.skinning.data());
  for (std::uint32_t v = 0; v < count; ++v) {
    const float *r = &frames[12 * std::size_t{v}], *t = r + 9;
    const DdmVertex& vertex = target.ddm.vertices[v];
    const Eigen::Matrix3d rotation = Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(r).cast<double>();
    const Eigen::Vector3d offset = Eigen::Vector3f(vertex.offset_x, vertex.offset_y, vertex.offset_z).cast<double>();
    result.target.row(v) =
        (Eigen::Map<const Eigen::Vector3f>(t) + Eigen::Vector3f(rig.origin)).cast<double>() + rotation * offset;
    const Eigen::Quaterniond turn(rotation);
    result.rotation[v] = normalized({turn.x(), turn.y(), turn.z(), turn.w()});
  }
}

bool have_same_output(const MeshTable& a, const MeshTable& b) {
  return a.output_count() == b.output_count() && a.output_triangles == b.output_triangles;
}

void require_marker(std::uint32_t number, const MeshTable& mesh, const char* whose) {
  if (number < mesh.output_count()) return;
  throw Error(ErrorKind::mismatch, "a marker names vertex ", number, " of the ", whose, ", which has ",
              mesh.output_count(), ": the markers are of another file?");
}

// Clicks on the vertex of that number, or beside it, say nothing new.
bool agree_with_numbers(const std::vector<SkinMarker>& markers, const Basis& target, const Positions& skin) {
  const auto place = [&](std::uint32_t number) { return skin.row(target.mesh.output_vertex[number]); };
  const double near = kNear * longest_extent(skin);
  return std::ranges::all_of(
      markers, [&](const SkinMarker& marker) { return (place(marker.source) - place(marker.target)).norm() <= near; });
}

// The properties in which two skins are compared, per vertex.
struct Look {
  Positions normals;  // of any length
  JointShares shares;

  double alike(Eigen::Index vertex, const Look& other, const SkinPoint& at) const {
    const Eigen::RowVectorXd mixed = at_point(other.shares, at);
    const Eigen::Vector3d normal = at_point(other.normals, at);
    const double angle = normals.row(vertex).normalized().dot(normal.normalized().transpose());
    return std::max(0.0, angle) * mixed.cwiseMin(shares.row(vertex)).sum();
  }
};

// The points of another skin that the vertices of a skin lie on.
std::vector<SkinPoint> places_on(const Positions& skin, const Positions& normals, const NearestSkin& other) {
  std::vector<SkinPoint> places(static_cast<std::size_t>(skin.rows()));
  parallel_for(places.size(), [&](std::size_t v) {
    const auto row = static_cast<Eigen::Index>(v);
    const Eigen::Vector3d place = skin.row(row);
    places[v] = other.facing(place, normals.row(row).normalized());
    if (places[v].triangle < 0) places[v] = other(place);
  });
  return places;
}

Eigen::VectorXd alike_at(const Look& look, const Look& other, const std::vector<SkinPoint>& at) {
  Eigen::VectorXd alike(static_cast<Eigen::Index>(at.size()));
  parallel_for(at.size(), [&](std::size_t v) {
    const auto row = static_cast<Eigen::Index>(v);
    alike[row] = look.alike(row, other, at[v]);
  });
  return alike;
}

// Whether it is plausible that vertices of the same number are the same points.
void judge_numbers(const Basis& source, const Basis& target, const SkeletonMatch& match, const JointShares& from,
                   const JointShares& to, Correspondence& result) {
  const Look own{vertex_normals(result.target, rows_of(target.mesh.triangles)), to},
      warped{vertex_normals(warped_by_joints(source, target, match), rows_of(source.mesh.triangles)), from};
  result.alike = alike_at(own, warped, result.at);
  result.source_alike.resize(source.mesh.vertex_count());
  for (std::uint32_t o = 0; o < target.mesh.output_count(); ++o) {
    result.source_alike[source.mesh.output_vertex[o]] = result.alike[target.mesh.output_vertex[o]];
  }
  result.confidence = result.alike;
}

// Seams may have been welded otherwise: every vertex of either has an output vertex.
void match_by_number(const Basis& source, const Basis& target, Correspondence& result) {
  const MeshTable &from = source.mesh, &to = target.mesh;
  result.same_topology = true;
  result.fitted.resize(from.vertex_count(), 3);
  result.at.resize(to.vertex_count());
  for (std::uint32_t o = 0; o < to.output_count(); ++o) {
    const std::uint32_t s = from.output_vertex[o], t = to.output_vertex[o];
    result.fitted.row(s) = result.target.row(t);
    SkinPoint& point = result.at[t];
    point.vertices = {s, s, s};
    point.weights = {1, 0, 0};
    point.position = result.target.row(t);
    point.triangle = from.vertex_triangle_begin[s] < from.vertex_triangle_begin[s + 1]
                         ? static_cast<Eigen::Index>(from.vertex_triangles[from.vertex_triangle_begin[s]])
                         : -1;
  }
  result.distance = Eigen::VectorXd::Zero(to.vertex_count());
}

// Finds where the target's vertices lie on the fitted source, and how sure that is.
void match_by_place(const Basis& source, const Basis& target, const JointShares& source_shares,
                    const JointShares& target_shares, Correspondence& result) {
  const Triangles from = rows_of(source.mesh.triangles), to = rows_of(target.mesh.triangles);
  const Look fitted{vertex_normals(result.fitted, from), source_shares},
      own{vertex_normals(result.target, to), target_shares};
  result.at = places_on(result.target, own.normals, NearestSkin(result.fitted, from));
  result.alike = alike_at(own, fitted, result.at);
  result.source_alike = alike_at(fitted, own, places_on(result.fitted, fitted.normals, NearestSkin(result.target, to)));
  result.distance.resize(result.target.rows());
  for (Eigen::Index v = 0; v < result.distance.size(); ++v) {
    const Eigen::RowVector3d nearest = result.at[static_cast<std::size_t>(v)].position.transpose();
    result.distance[v] = (nearest - result.target.row(v)).norm();
  }
  const double near = kNear * longest_extent(result.target);
  result.confidence = result.alike.array() * (-(result.distance / near).array().square()).exp();
}

}  // namespace

Correspondence match_skins(const Basis& source, const Basis& target, const SkeletonMatch& match,
                           const std::vector<SkinMarker>& markers) {
  Correspondence result;
  pose_target(target, match, result);
  result.area = lumped_areas(result.target, rows_of(target.mesh.triangles));
  for (const SkinMarker& marker : markers) {
    require_marker(marker.source, source.mesh, "source");
    require_marker(marker.target, target.mesh, "target");
  }
  const JointShares from = source_joint_shares(source, match), to = target_joint_shares(target, match);
  if (have_same_output(source.mesh, target.mesh)) {
    if (agree_with_numbers(markers, target, result.target)) {
      match_by_number(source, target, result);
      judge_numbers(source, target, match, from, to, result);
      return result;
    }
    result.notes.emplace_back(
        "the triangles are the same, but markers say that vertices of one number are not the same points: the skins "
        "are matched by place");
  }
  result.fitted = register_skin(source, target, result.target, from, to, match, markers);
  match_by_place(source, target, from, to, result);
  return result;
}

Eigen::VectorXd source_confidence(const Correspondence& correspondence, const Triangles& triangles) {
  const NearestSkin nearest(correspondence.target, triangles);
  Eigen::VectorXd result = Eigen::VectorXd::Zero(correspondence.fitted.rows());
  parallel_for(static_cast<std::size_t>(result.size()), [&](std::size_t v) {
    const auto row = static_cast<Eigen::Index>(v);
    result[row] = at_point(correspondence.confidence, nearest(correspondence.fitted.row(row).transpose()));
  });
  return result;
}

Positions place_colours(const Positions& rest) {
  const Eigen::RowVector3d low = rest.colwise().minCoeff(), size = rest.colwise().maxCoeff() - low;
  Positions colours(rest.rows(), 3);
  for (Eigen::Index v = 0; v < rest.rows(); ++v) {
    for (int i = 0; i < 3; ++i) colours(v, i) = size[i] > 0 ? 0.05 + 0.75 * (rest(v, i) - low[i]) / size[i] : 0.4;
  }
  return colours;
}

Positions matched_colours(const Correspondence& correspondence, const Positions& colours) {
  Positions result = Positions::Zero(correspondence.target.rows(), 3);
  for (Eigen::Index v = 0; v < result.rows(); ++v) {
    result.row(v) = at_point(colours, correspondence.at[static_cast<std::size_t>(v)]);
  }
  return result;
}

}  // namespace bodyopt::trainer
