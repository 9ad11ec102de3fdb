#include "trainer/dynamics/jiggle_anatomy.h"

#include <Eigen/LU>

#include "trainer/simulate/node_weights.h"

namespace bodyopt {
namespace {

// Of the body's volume: what is larger is no end of a limb, though no joint comes after it (half a worm). A person's
// head is a fourteenth.
constexpr double kLargestEnd = 1.0 / 8;

// Joints that move skin, with such above them and none below.
std::vector<bool> ends_of_limbs(const Character& character, const Eigen::VectorXd& volume_shares) {
  const std::vector<Joint>& joints = character.skeleton.joints;
  std::vector<bool> moves(joints.size(), false), moves_above(joints.size(), false), moves_below(joints.size(), false);
  for (const std::vector<JointWeight>& weights : character.weights) {
    for (const JointWeight& w : weights) moves[w.joint] = moves[w.joint] || w.weight > 0;
  }
  const auto parent = [&](std::size_t j) { return static_cast<std::size_t>(joints[j].parent); };
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (joints[j].parent >= 0) moves_above[j] = moves[parent(j)] || moves_above[parent(j)];
  }
  for (std::size_t j = joints.size(); j-- > 0;) {
    if (joints[j].parent >= 0 && (moves[j] || moves_below[j])) moves_below[parent(j)] = true;
  }
  std::vector<bool> ends(joints.size());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    ends[j] =
        moves[j] && moves_above[j] && !moves_below[j] && volume_shares[static_cast<Eigen::Index>(j)] < kLargestEnd;
  }
  return ends;
}

}  // namespace

JiggleAnatomy find_anatomy(const Character& character, const AnatomyField& field, std::size_t muscle_count,
                           const Cage& cage, const Materials& materials) {
  const TetMesh& mesh = cage.mesh;
  const Eigen::Index nodes = mesh.nodes.rows();
  const auto joints = static_cast<Eigen::Index>(character.skeleton.size());
  const auto tets = static_cast<std::size_t>(mesh.tets.rows());
  const SparseMatrix laplacian = tet_laplacian(mesh, std::vector<double>(tets, 1)), no_springs(nodes, nodes);
  JiggleAnatomy anatomy;
  anatomy.joint_share = carry_through(character, cage, laplacian, no_springs, NodeWeights::Zero(nodes, joints));
  anatomy.tissue = find_tissue(cage, field);
  anatomy.bone_springs =
      BoneSprings(mesh, anatomy.tissue.bones, bone_stiffness(materials, mesh), character.skeleton.size()).stiffness();

  anatomy.muscle_share = Eigen::MatrixXd::Zero(nodes, static_cast<Eigen::Index>(muscle_count));
  Eigen::VectorXd volume = Eigen::VectorXd::Zero(nodes);  // around each node
  std::vector<double> of_tet(tets);
  for (std::size_t t = 0; t < tets; ++t) {
    const auto tet = static_cast<Eigen::Index>(t);
    of_tet[t] = tet_edges(mesh, tet).determinant() / 6;
    for (int a = 0; a < 4; ++a) volume[mesh.tets(tet, a)] += of_tet[t];
  }
  anatomy.is_end = ends_of_limbs(character, anatomy.joint_share.transpose() * volume / volume.sum());
  for (const FibreTet& fibre : anatomy.tissue.fibres) {
    const auto t = static_cast<std::size_t>(fibre.tet);
    for (int a = 0; a < 4; ++a) {
      const int node = mesh.tets(fibre.tet, a);
      anatomy.muscle_share(node, fibre.muscle) += fibre.share * of_tet[t] / volume[node];
    }
  }
  return anatomy;
}

}  // namespace bodyopt
