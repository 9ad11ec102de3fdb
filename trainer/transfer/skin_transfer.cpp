#include "trainer/transfer/skin_transfer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/progress.h"
#include "base/wording.h"
#include "geometry/surface_distance.h"
#include "runtime/basis/joint_omegas.h"
#include "runtime/core/error.h"
#include "runtime/host/device_choice.h"
#include "runtime/host/rig.h"
#include "trainer/train/fit/train.h"

namespace bodyopt::trainer {
namespace {

// Column of every joint of a skeleton: `column` of itself, or of the nearest joint above that has one; else the first.
std::vector<Eigen::Index> columns_of(const Skeleton& skeleton, const std::vector<int>& column) {
  std::vector<Eigen::Index> result(skeleton.size(), 0);
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    if (column[j] >= 0) {
      result[j] = column[j];
    } else if (parent >= 0) {
      result[j] = result[static_cast<std::size_t>(parent)];
    }
  }
  return result;
}

JointShares shares_of(const Basis& basis, const std::vector<Eigen::Index>& columns, Eigen::Index count) {
  JointShares shares = JointShares::Zero(basis.mesh.vertex_count(), count);
  for (std::uint32_t v = 0; v < basis.mesh.vertex_count(); ++v) {
    for_each_omega(basis.ddm, v, [&](std::uint32_t joint, double omega) { shares(v, columns[joint]) += omega; });
  }
  return shares;
}

// Per joint of the source, the lengths of its bones to the nearest matched joints below: target's over source's; or 0.
std::vector<double> bone_ratios(const Skeleton& source, const SkeletonMatch& match, const Positions& from,
                                const Positions& to) {
  std::vector<double> own(source.size(), 0.0), other = own;
  for (std::size_t j = 0; j < source.size(); ++j) {
    const int above = matched_at_or_above(source, match.target_joint, source.joints[j].parent);
    if (above < 0 || match.target_joint[j] < 0) continue;
    const auto a = static_cast<std::size_t>(above);
    own[a] += (from.row(static_cast<Eigen::Index>(j)) - from.row(above)).norm();
    other[a] += (to.row(match.target_joint[j]) - to.row(match.target_joint[a])).norm();
  }
  for (std::size_t j = 0; j < own.size(); ++j) own[j] = own[j] > 0 ? other[j] / own[j] : 0;
  return own;
}

void require_takes(const SampleSet& set, const std::set<std::string>& names) {
  for (const std::string& name : names) {
    if (std::ranges::find(set.takes, name) != set.takes.end()) continue;
    throw Error(ErrorKind::usage, "the dataset has no take '", name, "' with frames to train on; there are ",
                list_names(set.takes));
  }
}

// Takes the samples of the body's own frames out of the set, which keeps the carried ones.
std::vector<Sample> take_own(SampleSet& set, const std::set<std::string>& carried) {
  const auto is_carried = [&](const Sample& sample) { return carried.contains(set.take_of(sample)); };
  const auto own = std::stable_partition(set.train.begin(), set.train.end(), is_carried);
  std::vector<Sample> taken(std::make_move_iterator(own), std::make_move_iterator(set.train.end()));
  set.train.erase(own, set.train.end());
  if (taken.empty()) {
    throw Error(ErrorKind::mismatch,
                "all takes are carried: there is no frame of the body's own to learn from; simulate some into the "
                "dataset");
  }
  if (set.train.empty()) throw Error(ErrorKind::mismatch, "no frame of the carried takes is trained on");
  return taken;
}

// A part of the target's extent: how far a gradient's error is summed before the anchors take over. Of 0.05, 0.1, 0.25,
// 0.5, 1 and 3 this left the least between two builds of one human (docs/notes, Transfer).
constexpr double kReach = 0.1;

// Lengths of the target over those of the source, around every vertex, smoothed over a tenth of the reach.
Eigen::VectorXd local_sizes(const Positions& source, const Positions& target, const Triangles& triangles) {
  const Eigen::VectorXd ratios =
      (lumped_areas(target, triangles).array() / lumped_areas(source, triangles).array()).sqrt();
  return smoothed(target, triangles, ratios, 0.1 * kReach * longest_extent(target));
}

Eigen::SparseMatrix<double> stiffness(const std::vector<HatGradients>& gradients, const Triangles& triangles,
                                      Eigen::Index vertices) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(9 * gradients.size());
  for (std::size_t t = 0; t < gradients.size(); ++t) {
    const Eigen::Matrix3d products = gradients[t].area * gradients[t].of_corner.transpose() * gradients[t].of_corner;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        const auto row = static_cast<Eigen::Index>(t);
        entries.emplace_back(static_cast<int>(triangles(row, i)), static_cast<int>(triangles(row, k)), products(i, k));
      }
    }
  }
  return sparse_matrix(vertices, vertices, entries);
}

// Vertices of the same number are the same points, however unlike they look.
std::vector<int> unsure_vertices(const Correspondence& correspondence) {
  if (correspondence.same_topology) return {};
  return rows_below(correspondence.confidence, kSureConfidence);
}

}  // namespace

JointShares source_joint_shares(const Basis& source, const SkeletonMatch& match) {
  std::vector<int> column(match.target_joint.size(), -1);
  for (std::size_t j = 0; j < column.size(); ++j) {
    if (match.target_joint[j] >= 0) column[j] = static_cast<int>(j);
  }
  return shares_of(source, columns_of(source.skeleton, column), static_cast<Eigen::Index>(source.skeleton.size()));
}

JointShares target_joint_shares(const Basis& target, const SkeletonMatch& match) {
  return shares_of(target, columns_of(target.skeleton, match.source_joint),
                   static_cast<Eigen::Index>(match.target_joint.size()));
}

Eigen::VectorXd share_of_matched(const Basis& basis, const std::vector<int>& match) {
  Eigen::VectorXd shares = Eigen::VectorXd::Zero(basis.mesh.vertex_count());
  for (std::uint32_t v = 0; v < basis.mesh.vertex_count(); ++v) {
    for_each_omega(basis.ddm, v, [&](std::uint32_t joint, double omega) {
      if (match[joint] >= 0) shares[v] += omega;
    });
  }
  return shares;
}

std::vector<JointWarp> joint_warps(const Basis& source, const Basis& target, const SkeletonMatch& match) {
  const Positions from = joint_places(source.skeleton, bind_pose(source.skeleton)),
                  to = joint_places(target.skeleton, match.common);
  const std::vector<double> ratios = bone_ratios(source.skeleton, match, from, to);
  std::vector<JointWarp> warps(source.skeleton.size());
  for (std::size_t j = 0; j < warps.size(); ++j) {
    const int parent = source.skeleton.joints[j].parent, other = match.target_joint[j];
    if (other < 0 && parent >= 0) {
      warps[j] = warps[static_cast<std::size_t>(parent)];
      continue;
    }
    const double inherited = parent >= 0 ? warps[static_cast<std::size_t>(parent)].size : match.size;
    warps[j] = {from.row(static_cast<Eigen::Index>(j)), to.row(std::max(other, 0)),
                ratios[j] > 0 ? ratios[j] : inherited};
  }
  return warps;
}

Positions warped_by_joints(const Basis& source, const Basis& target, const SkeletonMatch& match) {
  const std::vector<JointWarp> warps = joint_warps(source, target, match);
  const JointShares shares = source_joint_shares(source, match);
  const Positions rest = rows_of(source.mesh.rest);
  Positions result = Positions::Zero(rest.rows(), 3);
  for (Eigen::Index j = 0; j < shares.cols(); ++j) {
    const JointWarp& warp = warps[static_cast<std::size_t>(j)];
    for (Eigen::Index v = 0; v < rest.rows(); ++v) {
      if (shares(v, j) > 0) result.row(v) += shares(v, j) * (warp.to + warp.size * (rest.row(v) - warp.from));
    }
  }
  return result;
}

std::string refinement_of(const std::string& take) { return "refined " + take; }

RefinedShapes::RefinedShapes(SampleSet set, const std::set<std::string>& carried, const TrainOptions& options) {
  require_takes(set, carried);
  set.heldout.clear();
  std::vector<Sample> own = take_own(set, carried);
  const Basis learned = train(set, options).basis;
  carried_ = std::make_unique<Deformer>(learned, DeviceChoice{.name = "cpu"});
  bare_ = std::make_unique<Deformer>(learned, DeviceChoice{.name = "cpu"});
  bare_->set_weights({.correction = 0});
  double sum = 0;
  Progress progress("transfer: what is off", own.size());
  for (Sample& sample : own) {
    const Positions off = sample.shape.read() - welded_from_output(set.character, of(*carried_, sample.pose).data());
    sum += off.squaredNorm() / static_cast<double>(off.rows());
    sample.shape = SampleShape(welded_from_output(set.character, of(*bare_, sample.pose).data()) + off);
    progress.advance();
  }
  difference_mm_ = 1e3 * std::sqrt(sum / static_cast<double>(own.size()));
  set.train = std::move(own);
  own_ = std::make_unique<Deformer>(train(set, options).basis, DeviceChoice{.name = "cpu"});
}

std::vector<float> RefinedShapes::of(Deformer& deformer, const Pose& pose) const {
  return deformer.evaluate({&pose, 1}).positions;
}

std::vector<float> RefinedShapes::operator()(const Pose& pose) {
  std::vector<float> shape = of(*carried_, pose);
  const std::vector<float> bare = of(*bare_, pose), own = of(*own_, pose);
  for (std::size_t k = 0; k < shape.size(); ++k) shape[k] += own[k] - bare[k];
  return shape;
}

HatGradients hat_gradients(const Positions& vertices, const Triangles& triangles, Eigen::Index triangle) {
  const auto corner = [&](int k) -> Eigen::Vector3d { return vertices.row(triangles(triangle, k)); };
  const Eigen::Vector3d along = corner(1) - corner(0), across = corner(2) - corner(0);
  const Eigen::Vector3d twice = along.cross(across);
  const double area2 = twice.norm();
  HatGradients result;
  if (!(area2 > 1e-10 * std::max(along.squaredNorm(), across.squaredNorm()))) return result;
  result.normal = twice / area2;
  result.area = 0.5 * area2;
  for (int k = 0; k < 3; ++k) {
    result.of_corner.col(k) = result.normal.cross(corner((k + 2) % 3) - corner((k + 1) % 3)) / area2;
  }
  return result;
}

DeformationTransfer::DeformationTransfer(const Positions& source, const Positions& target, const Triangles& triangles,
                                         TransferSize size)
    : triangles_(triangles) {
  const double reach = kReach * longest_extent(target);
  const Eigen::VectorXd sizes = local_sizes(source, target, triangles);
  sizes_ = size == TransferSize::local ? sizes : Eigen::VectorXd::Ones(target.rows());
  anchors_ = lumped_areas(target, triangles) / (reach * reach);
  std::vector<HatGradients> on_target;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    on_target.push_back(hat_gradients(target, triangles, t));
    const double mean = (sizes[triangles(t, 0)] + sizes[triangles(t, 1)] + sizes[triangles(t, 2)]) / 3;
    pairs_.push_back(
        {hat_gradients(source, triangles, t), on_target.back(), size == TransferSize::local ? 1 : 1 / mean});
  }
  Eigen::SparseMatrix<double> matrix = stiffness(on_target, triangles, target.rows());
  matrix.diagonal() += anchors_;
  solver_ = SparseSolver(matrix);
}

Positions DeformationTransfer::operator()(const Positions& displacements) const {
  Eigen::MatrixXd right = (anchors_.array() * sizes_.array()).matrix().asDiagonal() * displacements;
  for (std::size_t t = 0; t < pairs_.size(); ++t) {
    const auto& [source, target, scale] = pairs_[t];
    const auto row = static_cast<Eigen::Index>(t);
    Eigen::Matrix3d corners;  // displacements as columns
    for (int k = 0; k < 3; ++k) corners.col(k) = displacements.row(triangles_(row, k)).transpose();
    if (corners.isZero(0)) continue;
    const Eigen::Matrix3d gradient = corners * source.of_corner.transpose();
    const Eigen::Matrix3d wanted = gradient - gradient.transpose() * source.normal * source.normal.transpose();
    const Eigen::Matrix3d pull = scale * target.area * wanted * target.of_corner;
    for (int k = 0; k < 3; ++k) right.row(triangles_(row, k)) += pull.col(k).transpose();
  }
  return solver_.solve(right);
}

SmoothFill::SmoothFill(const Positions& skin, const Triangles& triangles, std::vector<int> unknown)
    : unknown_(std::move(unknown)) {
  if (unknown_.empty()) return;
  std::vector<int> place(static_cast<std::size_t>(skin.rows()), -1);
  for (std::size_t k = 0; k < unknown_.size(); ++k) place[static_cast<std::size_t>(unknown_[k])] = static_cast<int>(k);
  const Eigen::VectorXd areas = lumped_areas(skin, triangles);
  anchors_ = 1e-6 / areas.mean() * areas(unknown_);
  const Eigen::SparseMatrix<double> membrane = cotangent_laplacian(skin, triangles);
  std::vector<Eigen::Triplet<double>> among, across;
  for (int column = 0; column < membrane.outerSize(); ++column) {
    const int to = place[static_cast<std::size_t>(column)];
    for (Eigen::SparseMatrix<double>::InnerIterator entry(membrane, column); entry; ++entry) {
      const int from = place[static_cast<std::size_t>(entry.row())];
      if (from < 0) continue;
      if (to < 0) {
        across.emplace_back(from, column, -entry.value());
      } else {
        among.emplace_back(from, to, entry.value());
      }
    }
  }
  for (int k = 0; k < static_cast<int>(unknown_.size()); ++k) among.emplace_back(k, k, anchors_[k]);
  const auto count = static_cast<Eigen::Index>(unknown_.size());
  from_known_ = sparse_matrix(count, skin.rows(), across);
  solver_ = SparseSolver(sparse_matrix(count, count, among));
}

void SmoothFill::operator()(Eigen::MatrixXd& values) const {
  if (unknown_.empty()) return;
  const Eigen::MatrixXd right =
      from_known_ * values + anchors_.asDiagonal() * Eigen::MatrixXd(values(unknown_, Eigen::all));
  const Eigen::MatrixXd filled = solver_.solve(right);
  values(unknown_, Eigen::all) = filled;
}

std::vector<int> rows_below(const Eigen::VectorXd& values, double least) {
  std::vector<int> rows;
  for (int v = 0; v < static_cast<int>(values.size()); ++v) {
    if (values[v] < least) rows.push_back(v);
  }
  return rows;
}

SkinTransfer::SkinTransfer(const Basis& source, const Basis& target, const Correspondence& correspondence,
                           TransferSize size)
    : correspondence_(correspondence),
      transfer_(rows_of(source.mesh.rest), correspondence.fitted, rows_of(source.mesh.triangles), size),
      fill_(correspondence.target, rows_of(target.mesh.triangles), unsure_vertices(correspondence)) {}

Positions SkinTransfer::operator()(const Positions& displacements) const {
  const Positions fitted = transfer_(displacements);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(correspondence_.target.rows(), 3);
  for (Eigen::Index v = 0; v < result.rows(); ++v) {
    const SkinPoint& at = correspondence_.at[static_cast<std::size_t>(v)];
    for (int k = 0; k < 3; ++k) {
      if (at.weights[k] != 0) result.row(v) += at.weights[k] * fitted.row(at.vertices[static_cast<std::size_t>(k)]);
    }
  }
  for (const int v : fill_.unknown()) result.row(v).setZero();  // a piece without a sure vertex does not move
  fill_(result);
  for (Eigen::Index v = 0; v < result.rows(); ++v) {
    const Quat& turn = correspondence_.rotation[static_cast<std::size_t>(v)];
    if (turn == Quat{0, 0, 0, 1}) continue;
    const Vec3 back = rotate(conjugate(turn), {result(v, 0), result(v, 1), result(v, 2)});
    result.row(v) << back[0], back[1], back[2];
  }
  return result;
}

}  // namespace bodyopt::trainer
