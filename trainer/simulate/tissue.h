// What fills the tets: passive tissue and muscles with a fibre direction; and what bones hold.
#pragma once

#include <vector>

#include "trainer/dataset/character.h"
#include "trainer/dataset/muscles.h"
#include "trainer/simulate/tets.h"

namespace bodyopt {

// Per tet, rest space.
struct Tissue {
  std::vector<int> muscle;             // index, or -1 for passive tissue
  std::vector<Eigen::Vector3d> fibre;  // unit direction; zero in passive tissue
};

// A tet belongs to the muscle whose belly its centroid lies in (the relatively nearest one). The belly is thick in the
// middle of the path and tapers to its ends; fibres run along the path.
Tissue label_tissue(const TetMesh& mesh, const std::vector<Muscle>& muscles);

// Length of a muscle's path when every joint j carries its points by skinning[j] (rest to posed), metres.
double path_length(const Muscle& muscle, const std::vector<Affine>& skinning);

// Activation of every muscle in a pose, 0 .. max_activation: a smooth function of how much its path is shorter than at
// rest. Zero at rest, so that the bind pose is an equilibrium of the rest shape. No hidden state.
std::vector<double> activations(const std::vector<Muscle>& muscles, const std::vector<Affine>& skinning);

// A point inside a tet that a joint carries: held by a spring of kBoneSpring.
struct Attachment {
  int tet;
  Eigen::Vector4d weights;  // barycentric
  std::uint32_t joint;
  Eigen::Vector3d position;  // rest space, metres
};

// Bones, which characters do not bring as meshes: rods along the segments from joint to child joint (an end joint's
// reaches into the vertices it carries), as thick as a third of the flesh around them allows and clear of the hinges,
// and the core of thick parts such as the trunk.
std::vector<Attachment> attach_bones(const TetMesh& mesh, const Character& character,
                                     const Eigen::MatrixXd& node_weights);

// N x J: skin weights of the character, diffused harmonically into the interior. Rows sum to 1.
Eigen::MatrixXd interior_weights(const TetMesh& mesh, const Character& character);

}  // namespace bodyopt
