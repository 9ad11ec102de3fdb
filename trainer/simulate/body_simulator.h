// One pose to one shape: continuation from rest along a straight path in joint angles.
#pragma once

#include "trainer/simulate/equilibrium.h"

namespace bodyopt {

struct SimulatedShape {
  Positions nodes;  // N x 3, posed, metres
  SolveResult solve;
  bool stalled = false;  // the path could not be followed to its end
};

// Const after construction; several threads may simulate at once. The shape of a pose depends on nothing but the pose.
class BodySimulator {
 public:
  BodySimulator(const Character& character, const std::vector<Muscle>& muscles, double tet_size);

  SimulatedShape simulate(const Pose& pose) const;
  const TetMesh& mesh() const { return mesh_; }
  const Tissue& tissue() const { return tissue_; }

 private:
  std::vector<Affine> path_matrices(const Pose& pose, double along) const;
  Drive drive(const std::vector<Affine>& skinning) const;
  // Carries the un-posed displacement of `x` from one pose to another.
  Positions carry(const Positions& x, const std::vector<Affine>& from, const std::vector<Affine>& to) const;

  const Character& character_;
  const std::vector<Muscle>& muscles_;
  TetMesh mesh_;
  Eigen::MatrixXd weights_;
  Tissue tissue_;
  std::vector<Attachment> attachments_;
  ElasticBody body_;
  EquilibriumSolver solver_;
};

}  // namespace bodyopt
