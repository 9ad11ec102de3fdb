// Un-posed displacements of one character's skin, carried to another's.
#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "base/linear_algebra.h"
#include "geometry/mesh.h"
#include "runtime/basis/basis.h"
#include "runtime/deformer/deformer.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/options.h"
#include "trainer/transfer/correspondence.h"
#include "trainer/transfer/match_skeletons.h"

namespace bodyopt::trainer {

// How much of each vertex the joints hold that both characters have, and where they bring the source's body.

// V x joints of the source: the omegas of Direct Delta Mush, each row summing to 1. Joints that the other does not have
// count as the nearest above them that it has.
using JointShares = Eigen::MatrixXd;

JointShares source_joint_shares(const Basis& source, const SkeletonMatch& match);
JointShares target_joint_shares(const Basis& target, const SkeletonMatch& match);

// V: of each vertex, what joints hold that have a match themselves; `match`: per joint of the basis, -1 for none.
Eigen::VectorXd share_of_matched(const Basis& basis, const std::vector<int>& match);

// x -> to + size (x - from), from the source's rest to the common pose, metres.
struct JointWarp {
  Eigen::RowVector3d from, to;
  double size = 1;
};

// Per joint of the source, scaled as its bones are on the mean, or as the joint above, or as the whole body. A joint
// without a match goes with the one above.
std::vector<JointWarp> joint_warps(const Basis& source, const Basis& target, const SkeletonMatch& match);

// The source's rest skin (V x 3, runtime order), every joint moving its share.
Positions warped_by_joints(const Basis& source, const Basis& target, const SkeletonMatch& match);

// Refinement of what was carried to a body, by that body's own frames.

// The modifier in a dataset's stack that holds what refining made of a carried take.
std::string refinement_of(const std::string& take);

// A cheap model of much and a dear one of little (Kennedy and O'Hagan 2000). The carried frames are learned, then what
// the body's own frames differ by from that. The difference is small and changes little with the pose, so that few
// frames tell it. Where the own frames know nothing, what was carried stays.
class RefinedShapes {
 public:
  // `carried`: names of takes of the set; all its other training frames are the body's own. Shows progress. Throws
  // Error(usage) for a take that the set does not have, Error(mismatch) where either kind has too few frames, and as
  // train().
  RefinedShapes(SampleSet set, const std::set<std::string>& carried, const TrainOptions& options);

  // O x 3, posed, metres, world.
  std::vector<float> operator()(const Pose& pose);
  // The difference of the own frames from what was carried, root mean square over vertices, millimetres.
  double difference_mm() const { return difference_mm_; }

 private:
  std::vector<float> of(Deformer& deformer, const Pose& pose) const;

  std::unique_ptr<Deformer> carried_, bare_, own_;  // as learned; its Direct Delta Mush; that with what own frames add
  double difference_mm_ = 0;
};

// Gradients of linear functions on a triangle.
struct HatGradients {
  Eigen::Matrix3d of_corner =
      Eigen::Matrix3d::Zero();                       // column k: gradient, 1/m, of what is 1 at corner k, 0 at others
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // of unit length, counter-clockwise seen from outside
  double area = 0;                                   // square metres
};

// The gradients on one triangle; all zero where it is degenerate.
HatGradients hat_gradients(const Positions& vertices, const Triangles& triangles, Eigen::Index triangle);

// How far a displacement reaches.
enum class TransferSize {
  local,  // by the local size of the target: a thin arm gets thin bulges
  source  // in metres, as on the source
};

// Deformation transfer (Sumner and Popovic 2004) between two skins of the same triangles. The gradient D of the
// source's displacement, with the normal's change made linear, is wanted on the target: H = D - (D^T n) n^T. The
// target's displacements d' minimise sum_t area_t |grad d' - H|^2 + sum_i area_i / reach^2 |d'_i - s_i d_i|^2. The
// target's own normals drop out, as they may move freely (Botsch and others 2006). The factor s_i is the target's local
// size over the source's; for TransferSize::source it is 1, and H is divided by that size. The second term settles
// where the whole stands, which gradients do not tell. It keeps small errors from adding up along a body; `reach` is a
// tenth of the target's extent. The result is linear in the displacements, and zero of zero. One factorisation, made on
// construction.
class DeformationTransfer {
 public:
  // V x 3 each, metres, in the same axes; T x 3.
  DeformationTransfer(const Positions& source, const Positions& target, const Triangles& triangles, TransferSize size);

  // V x 3, source, to V x 3, target; metres. On any thread.
  Positions operator()(const Positions& displacements) const;

 private:
  struct TrianglePair {
    HatGradients source, target;
    double scale = 1;  // of the gradient
  };

  const Triangles triangles_;
  std::vector<TrianglePair> pairs_;
  Eigen::VectorXd anchors_;  // V: area / reach^2
  Eigen::VectorXd sizes_;    // V: s
  SparseSolver solver_;
};

// Fills in values of some vertices of a skin smoothly from all others. They are harmonic in the cotangent Laplacian
// (weight inpainting as of Abdrashitov and others 2023). One factorisation, made on construction.
class SmoothFill {
 public:
  // `skin`: V x 3; `unknown`: the vertices to fill in, rising.
  SmoothFill(const Positions& skin, const Triangles& triangles, std::vector<int> unknown);

  // V x any: changes the rows of `unknown`. Where nothing around is known, as in a piece of its own, they take their
  // mean by area. On any thread.
  void operator()(Eigen::MatrixXd& values) const;

  const std::vector<int>& unknown() const { return unknown_; }

 private:
  std::vector<int> unknown_;
  Eigen::VectorXd anchors_;                 // per unknown vertex, so small that only a piece of its own feels it
  Eigen::SparseMatrix<double> from_known_;  // unknown x V
  SparseSolver solver_;
};

// Rows whose value is below `least`, rising.
std::vector<int> rows_below(const Eigen::VectorXd& values, double least);

// Deformation transfer from the source's rest skin to the same triangles laid onto the target, and on to the target's
// vertices. Where the correspondence is unsure, values are filled in smoothly (harmonically) from around. The result is
// turned from the common pose to the target's own rest. Linear; zero of zero.
class SkinTransfer {
 public:
  SkinTransfer(const Basis& source, const Basis& target, const Correspondence& correspondence, TransferSize size);

  // V x 3, runtime order of the source, to V' x 3, runtime order of the target; metres, un-posed. On any thread.
  Positions operator()(const Positions& displacements) const;

  // Fills in the target's skin, runtime order, where the correspondence is unsure.
  const SmoothFill& fill() const { return fill_; }
  Eigen::Index unsure() const { return static_cast<Eigen::Index>(fill_.unknown().size()); }  // vertices filled in

 private:
  const Correspondence& correspondence_;
  DeformationTransfer transfer_;
  SmoothFill fill_;
};

}  // namespace bodyopt::trainer
