// The shape a body takes in a pose: elastic equilibrium between bones that drive and skin that is free.
#pragma once

#include <limits>
#include <memory>
#include <optional>

#include "assets/characters/character.h"
#include "dataset/dataset.h"
#include "trainer/simulate/bone_springs.h"
#include "trainer/simulate/contact.h"
#include "trainer/simulate/lbfgs.h"
#include "trainer/simulate/muscle_fibres.h"
#include "trainer/simulate/muscle_volume.h"
#include "trainer/simulate/skin_bending.h"
#include "trainer/tets/loose_pieces.h"

namespace bodyopt::trainer {

struct SolvedPose {
  Positions nodes;     // N x 3, those of the body's tets, then the R vertices of loose pieces; posed, metres
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

  // Poses are reached in `linear` from now on, the body of the linear tets that this one's were made of (second_order).
  // They are only settled in this one.
  void walk_in(std::unique_ptr<const QuasiStaticBody> linear);

  // A frame that takes this many iterations, all attempts together, is given up: it does not converge, and its
  // residual is infinite. So is one that converges deep in skin, if trying again takes this long. Others are the same
  // as without.
  void give_up_after(int iterations) { most_iterations_ = iterations; }

  // A body of the same skin in fewer, larger tets, to estimate its discretisation error.
  void compare_with(std::unique_ptr<const QuasiStaticBody> coarser) { coarser_ = std::move(coarser); }
  // The distance of a solved pose's skin (V x 3) from that in ever smaller tets, metres, RMS. It follows from the
  // distance to the coarser body's if errors fall with the square of the tets' size (Richardson). Not a number without
  // a coarser body, if that does not converge, or if its tets are hardly larger.
  double discretisation_error(const Pose& pose, std::span<const double> flex, const Positions& skin) const;

  // The equilibrium reached from rest along the straight path in joint angles, a pure function of the pose. A single
  // root's motion is taken out and put back at the end: there is no gravity, so the body does not feel it. The linear
  // body (walk_in) takes the path where it comes to rest without deep folds; its shape is where this body starts.
  //
  // residual = sqrt(sum over all nodes of |f_i|^2) / sqrt(sum over all tets and their four nodes of |f_ta|^2). The
  // elastic force f_ta (passive, active and barrier terms together) is that of tet t on its node a. The force f_i is
  // the sum of those around node i, muscle volume, bone springs, bending, contact (of HeldContact) and eighths that are
  // held. No other forces hold a node. A pose is converged with a residual below 1e-4 and no inverted tet. An
  // unconverged frame, or one with skin more than 5 mm deep in skin, is tried again in smaller steps with a steeper
  // barrier. The second shape is kept if it converges and the first did not, or is deeper.
  //
  // flex: per muscle, 0 to 1, or empty. This share of what is left of its activation in the pose is added, raised from
  // 0 on the way to the pose.
  SolvedPose solve(const Pose& pose, std::span<const double> flex = {}) const {
    return solve_along(std::span(&pose, 1), flex);
  }
  // The equilibrium at the last of some poses (one at least), reached through the others: it shows how much a shape
  // depends on its path.
  SolvedPose solve_along(std::span<const Pose> path, std::span<const double> flex) const;

  // V x 3: where the nodes of a solved pose (N + R x 3) take the skin. A vertex of a loose piece is a node of its own.
  // Its joints move it by linear blending. It is then displaced, in its turned frame, as the body is where it holds the
  // piece (LoosePieces).
  Positions skin(const Positions& nodes) const { return embed(embedding_, carriers_, nodes); }

  const Skeleton& skeleton() const { return skeleton_; }
  const TetMesh& mesh() const { return mesh_; }
  Eigen::Index corner_count() const { return (linear_ ? linear_->mesh_ : mesh_).nodes.rows(); }  // without middles
  Eigen::Index node_count() const { return mesh_.nodes.rows() + static_cast<Eigen::Index>(riding_.size()); }  // N + R
  // The skin's carriers: the tets of the mesh, then for each vertex of a loose piece four times its own node.
  const Tets& carriers() const { return carriers_; }
  const std::vector<EmbeddedPoint>& embedding() const { return embedding_; }  // V, in the carriers
  const std::vector<std::uint32_t>& riding() const { return riding_; }        // R: vertices of the skin
  const TetTissue& tissue() const { return inside_; }
  const BoneSprings& springs() const { return *springs_; }
  const NodeWeights& weights() const { return weights_; }

  // xxh3 of everything a solution depends on, the pose apart: two bodies of the same hash give the same shapes, but for
  // frames that one of them gives up.
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
  // Keeps tets upright. `eighths`: it holds those of tets of second order, too. The points at which these are summed do
  // not see a corner that has passed through its tet.
  struct Upright {
    Tissue::BarrierShape barrier;
    bool eighths;
  };
  static constexpr Upright kAtFirst{Tissue::kBarrier, false}, kSteep{Tissue::kSteepBarrier, true},
      kFirm{Tissue::kFirmBarrier, true};
  // Each with the root's motion taken out, and without loose pieces. `spent` counts the iterations of the frame.
  SolvedPose attempt(std::span<const Pose> path, std::span<const double> flex, double step_size, const Upright& upright,
                     int& spent) const;
  std::optional<SolvedPose> settle_from_linear(const Pose& pose, std::span<const double> flex, int& spent) const;
  LocalTransforms without_root_motion(const Pose& pose) const;
  void put_back_root_motion(const Pose& pose, Positions& nodes) const;
  int inverted_tets(const Positions& nodes) const;  // of those that are summed and, of second order, those that carry
  void judge(SolvedPose& solved) const;             // sets its status but for residual and iterations
  Target target(const LocalTransforms& local, std::span<const double> flex) const;
  Positions carried(const Target& from, const Target& to, const Positions& nodes) const;
  // Makes the vertices of loose pieces nodes of their own.
  void take_loose_pieces(const Character& whole, const LoosePieces& loose_pieces);
  void append_loose_pieces(const Pose& pose, Positions& nodes) const;
  // at and contact must outlive it.
  Objective energy(const Target& at, std::span<const ContactPlane> contact, const Upright& upright,
                   bool hold_volume) const;
  // Keeps a shape near the path, roughly and without holding the volume of muscles.
  void follow(const Target& at, const Upright& upright, Positions& nodes, int& spent) const;
  // Relaxes to equilibrium, or as near as it gets, and returns the residual. Eighths that turn over on the way are held
  // from then on.
  double settle(const Target& at, Upright upright, Positions& nodes, int& spent) const;
  // Settles upright: sets the nodes and residual of `solved`.
  void settle_upright(const Target& at, const Upright& upright, SolvedPose& solved, int& spent) const;

  Skeleton skeleton_;
  std::vector<Muscle> muscles_;
  std::vector<double> bellies_;  // per muscle, metres
  double least_slack_ = 0;
  TetMesh mesh_;
  std::vector<EmbeddedPoint> embedding_;
  Tets carriers_;
  LoosePieces loose_pieces_;
  std::vector<std::uint32_t> riding_;
  Positions skin_rest_;       // V x 3, with loose pieces
  SkinWeights skin_weights_;  // V, with loose pieces
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
  double force_floor_ = 0, max_move_ = 0;                  // of the solver
  int most_iterations_ = std::numeric_limits<int>::max();  // of a frame
  std::uint64_t hash_ = 0;
};

}  // namespace bodyopt::trainer
