#include "trainer/dynamics/jiggle_anatomy.h"

#include <Eigen/LU>
#include <algorithm>

#include "trainer/simulate/node_weights.h"

namespace bodyopt {

JiggleAnatomy find_anatomy(const Character& character, const std::vector<Muscle>& muscles, const Cage& cage,
                           const Materials& materials) {
  const TetMesh& mesh = cage.mesh;
  const Eigen::Index nodes = mesh.nodes.rows();
  const auto joints = static_cast<Eigen::Index>(character.skeleton.size());
  const auto tets = static_cast<std::size_t>(mesh.tets.rows());
  const SparseMatrix laplacian = tet_laplacian(mesh, std::vector<double>(tets, 1)), no_springs(nodes, nodes);
  JiggleAnatomy anatomy;
  anatomy.joint_share = carry_through(character, cage, laplacian, no_springs, NodeWeights::Zero(nodes, joints));
  anatomy.bones = find_bones(cage, character, anatomy.joint_share);
  anatomy.bone_springs = BoneSprings(mesh, anatomy.bones, character.skeleton.size(), materials).stiffness();

  anatomy.muscle_of_tets.assign(tets, 0);
  anatomy.muscle_share = Eigen::MatrixXd::Zero(nodes, static_cast<Eigen::Index>(muscles.size()));
  Eigen::VectorXd volume = Eigen::VectorXd::Zero(nodes);  // around each node
  std::vector<double> of_tet(tets);
  for (std::size_t t = 0; t < tets; ++t) {
    const auto tet = static_cast<Eigen::Index>(t);
    of_tet[t] = tet_edges(mesh, tet).determinant() / 6;
    for (int a = 0; a < 4; ++a) volume[mesh.tets(tet, a)] += of_tet[t];
  }
  for (const FibreTet& fibre : label_muscles(cage, muscles)) {
    const auto t = static_cast<std::size_t>(fibre.tet);
    anatomy.muscle_of_tets[t] = std::min(anatomy.muscle_of_tets[t] + fibre.share, 1.0);
    for (int a = 0; a < 4; ++a) {
      const int node = mesh.tets(fibre.tet, a);
      anatomy.muscle_share(node, fibre.muscle) += fibre.share * of_tet[t] / volume[node];
    }
  }
  return anatomy;
}

}  // namespace bodyopt
