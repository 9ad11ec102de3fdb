// Springs by which bones go with their joints: energy = sum over bones 1/2 the integral of k |x - T_joint X|^2.
#pragma once

#include <span>
#include <vector>

#include "trainer/simulate/materials.h"
#include "trainer/simulate/node_weights.h"
#include "trainer/simulate/tet_tissue.h"

namespace bodyopt::trainer {

// The pull of the springs in one pose: energy, up to its constant, 1/2 u.S u - u.pull, u = nodes - base.
struct SpringPose {
  Positions base, pull;  // N x 3, metres and newtons
};

// N/m per cubic metre of bone in a body of this size: Materials::bone_springs up to the size of the largest human.
// Elastic forces grow with the square of a body's length, those of springs with its fourth power. A giant's bones, as
// stiff, would turn tets inside out: they give way by the same share of its length as a human's.
double bone_stiffness(const Materials& materials, const TetMesh& mesh);

class BoneSprings {
 public:
  // k: bone_stiffness().
  BoneSprings(const TetMesh& mesh, const std::vector<BonePart>& bones, double k, std::size_t joint_count);

  // skinning: J, rest space to posed.
  SpringPose pose(std::span<const Affine> skinning) const;
  // Adds the gradient at `nodes` (N x 3); returns the energy, joules, up to a constant of the pose.
  double add_gradient(const SpringPose& pose, const Positions& nodes, Positions& gradient) const;

  const SparseMatrix& stiffness() const { return stiffness_; }      // S, N x N, N/m
  const NodeWeights& joint_stiffness() const { return by_joint_; }  // N x J, N/m: row sums of S by joint

 private:
  // Moments of the springs to one joint around one node.
  struct Moment {
    int node, joint;
    double sum;             // N/m
    Eigen::Vector3d first;  // N: sum of stiffness x rest position
  };
  Positions rest_;
  SparseMatrix stiffness_;
  NodeWeights by_joint_;
  std::vector<Moment> moments_;  // by node
  std::vector<int> main_joint_;  // N: the joint with the largest share of a node's springs, -1 without springs
};

}  // namespace bodyopt::trainer
