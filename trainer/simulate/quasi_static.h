// The shape a body takes in a pose: elastic equilibrium between bones that drive and skin that is free.
#pragma once

#include <memory>
#include <optional>

#include "assets/character.h"
#include "dataset/dataset.h"
#include "trainer/simulate/bone_springs.h"
#include "trainer/simulate/contact.h"
#include "trainer/simulate/lbfgs.h"
#include "trainer/simulate/muscle_fibres.h"
#include "trainer/simulate/muscle_volume.h"
#include "trainer/simulate/skin_bending.h"
#include "trainer/tets/loose_pieces.h"

namespace bodyopt {

struct SolvedPose {
  Positions nodes;     // N x 3, those of the body's tets, then the R vertices that ride; posed, metres
  FrameStatus status;  // without the frame number
};

// residual below 1e-4 and no inverted tet.
bool is_converged(const FrameStatus& status);

// Everything that does not depend on the pose. Constant after construction: many threads may solve with one.
class QuasiStaticBody {
 public:
  // anatomy: what lies inside, of this character and these muscles; it is looked at here only.
  QuasiStaticBody(const Character& character, const std::vector<Muscle>& muscles, const AnatomyField& anatomy,
                  const Cage& cage, const Materials& materials = {});

  // From now on poses are reached in a body of the linear tets that this one's were made of (second_order), and only
  // settled in this one.
  void walk_in(std::unique_ptr<const QuasiStaticBody> linear);

  // A body of the same skin in fewer, larger tets, by which it can tell its discretisation error.
  void compare_with(std::unique_ptr<const QuasiStaticBody> coarser) { coarser_ = std::move(coarser); }
  // How far the skin of a solved pose (V x 3) is from that in ever smaller tets, metres, RMS: from the coarser body's,
  // errors taken to fall with the square of the tets' size (Richardson). Not a number without a coarser body, where
  // that does not converge, or whose tets are hardly larger.
  double discretisation_error(const Pose& pose, std::span<const double> flex, const Positions& skin) const;

  // The equilibrium reached from rest along the straight path in joint angles, a pure function of the pose. A single
  // root's motion is taken out and put back at the end: there is no gravity, so the body does not feel it. The linear
  // body (walk_in) takes the path where it comes to rest without deep folds; its shape is where this body starts.
  //
  // residual = sqrt(sum over all nodes of |f_i|^2) / sqrt(sum over all tets and their four nodes of |f_ta|^2), where
  // f_ta is the elastic force (passive, active and barrier terms together) of tet t on its node a, and f_i is the sum
  // of those around node i plus muscle volume, bone springs, the skin's bending and contact (of
  // HeldContact): no node is held otherwise. converged: residual below 1e-4 and no
  // inverted tet. A frame that has not come so far after kMaxIterations, or cannot, or whose skin lies more than 5 mm
  // deep in skin, is tried once more, in smaller steps and with a steeper barrier; the better shape is kept.
  //
  // flex: per muscle, 0 to 1, or empty: the share of what is left of its activation in the pose that is added, raised
  // from 0 along the path.
  SolvedPose solve(const Pose& pose, std::span<const double> flex = {}) const {
    return solve_along(std::span(&pose, 1), flex);
  }
  // The same at the last of some poses (one at least), reached through the others: how much a shape depends on its
  // path.
  SolvedPose solve_along(std::span<const Pose> path, std::span<const double> flex) const;

  // V x 3: where the nodes of a solved pose (N + R x 3) take the skin. A vertex that rides is a node of its own: it
  // goes where its joints take it by linear blending, displaced, in its turned frame, as the body is where it holds the
  // piece (LoosePieces).
  Positions skin(const Positions& nodes) const { return embed(embedding_, carriers_, nodes); }

  const Skeleton& skeleton() const { return skeleton_; }
  const TetMesh& mesh() const { return mesh_; }
  Eigen::Index corner_count() const { return (linear_ ? linear_->mesh_ : mesh_).nodes.rows(); }  // without middles
  Eigen::Index node_count() const { return mesh_.nodes.rows() + static_cast<Eigen::Index>(riding_.size()); }  // N + R
  // What carries the skin: the tets of the mesh, then for each vertex that rides four times its own node.
  const Tets& carriers() const { return carriers_; }
  const std::vector<EmbeddedPoint>& embedding() const { return embedding_; }  // V, in the carriers
  const std::vector<std::uint32_t>& riding() const { return riding_; }        // R: vertices of the skin
  const TetTissue& tissue() const { return inside_; }
  const BoneSprings& springs() const { return *springs_; }
  const NodeWeights& weights() const { return weights_; }

  // xxh3 of everything a solution depends on, the pose apart: two bodies of the same hash give the same shapes.
  std::uint64_t hash() const { return hash_; }

 private:
  using LocalTransforms = std::vector<JointTransform>;
  // A pose without the motion of the root, ready to solve in.
  struct Target {
    std::vector<FibreDrive> drives;
    SpringPose springs;
    Positions curvature;         // of the surface, turned with the joints; empty in a lattice
    Positions skinned;           // N x 3: the rest nodes by linear blend skinning
    std::vector<Quat> rotation;  // N: blended joint rotations
  };
  // What keeps tets upright. eighths: those of tets of second order, too; the points at which these are summed do not
  // see a corner that has passed through its tet.
  struct Upright {
    Tissue::BarrierShape barrier;
    bool eighths;
  };
  static constexpr Upright kAtFirst{Tissue::kBarrier, false}, kSteep{Tissue::kSteepBarrier, true},
      kFirm{Tissue::kFirmBarrier, true};
  // Each with the root's motion taken out, and without what rides.
  SolvedPose attempt(std::span<const Pose> path, std::span<const double> flex, double step_size,
                     const Upright& upright) const;
  std::optional<SolvedPose> settle_from_linear(const Pose& pose, std::span<const double> flex) const;
  LocalTransforms without_root_motion(const Pose& pose) const;
  void put_back_root_motion(const Pose& pose, Positions& nodes) const;
  int inverted_tets(const Positions& nodes) const;  // of those that are summed and, of second order, those that carry
  void judge(SolvedPose& solved) const;             // sets its status but for residual and iterations
  Target target(const LocalTransforms& local, std::span<const double> flex) const;
  Positions carried(const Target& from, const Target& to, const Positions& nodes) const;
  // What rides becomes nodes of its own.
  void take_loose_pieces(const Character& whole, const LoosePieces& loose_pieces);
  void append_loose_pieces(const Pose& pose, Positions& nodes) const;
  // at and contact must outlive it.
  Objective energy(const Target& at, std::span<const ContactPlane> contact, const Upright& upright,
                   bool hold_volume) const;
  // Keeps a shape near the path, roughly and without holding the volume of muscles. Returns iterations.
  int follow(const Target& at, const Upright& upright, Positions& nodes) const;
  // To equilibrium, or as near as it gets. Eighths that turn over on the way are held from then on.
  MinimiseResult settle(const Target& at, Upright upright, Positions& nodes) const;
  // The same, upright: sets the nodes, iterations and residual of `solved`.
  void settle_upright(const Target& at, const Upright& upright, SolvedPose& solved) const;

  Skeleton skeleton_;
  std::vector<Muscle> muscles_;
  std::vector<double> bellies_;  // per muscle, metres
  double least_slack_ = 0;
  TetMesh mesh_;
  std::vector<EmbeddedPoint> embedding_;
  Tets carriers_;
  LoosePieces loose_pieces_;
  std::vector<std::uint32_t> riding_;
  Positions skin_rest_;       // V x 3, where something rides
  SkinWeights skin_weights_;  // V, where something rides
  TetTissue inside_;
  NodeWeights weights_;
  std::vector<std::vector<JointWeight>> node_joints_;  // N: the weights again, small ones dropped, sum 1
  std::unique_ptr<Tissue> tissue_;
  std::unique_ptr<Tissue> eighths_;  // of tets of second order, which carry the skin; null in linear ones
  std::unique_ptr<MuscleVolume> volume_;
  std::unique_ptr<BoneSprings> springs_;
  std::unique_ptr<SkinBending> bending_;  // null in a lattice, whose surface is steps
  std::unique_ptr<SkinContact> contact_;
  std::unique_ptr<Metric> metric_;
  std::unique_ptr<const QuasiStaticBody> linear_;  // null where poses are walked to in the own tets
  SparseMatrix from_corners_;                      // N x C: from the nodes of the linear tets; empty in linear tets
  std::unique_ptr<const QuasiStaticBody> coarser_;
  double force_floor_ = 0, max_move_ = 0;  // of the solver
  std::uint64_t hash_ = 0;
};

}  // namespace bodyopt
