#include "trainer/simulate/node_weights.h"

#include "base/linear_algebra.h"
#include "runtime/core/error.h"

namespace bodyopt::trainer {
namespace {

// How hard a skin vertex pulls a cage's nodes to its own weights, in mean diagonals of the Laplacian.
constexpr double kSkinPull = 10;

NodeWeights skin_weights(const Character& character) {
  NodeWeights weights =
      NodeWeights::Zero(character.vertices.rows(), static_cast<Eigen::Index>(character.skeleton.size()));
  for (std::size_t v = 0; v < character.weights.size(); ++v) {
    for (const JointWeight& w : character.weights[v]) {
      weights(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(w.joint)) = w.weight;
    }
  }
  return weights;
}

void require(const SparseSolver& factor) {
  if (!factor.is_solvable()) throw Error(ErrorKind::mismatch, "the tetrahedra are too flat to carry weights");
}

void normalise(NodeWeights& weights) {
  weights = weights.cwiseMax(0);
  for (Eigen::Index n = 0; n < weights.rows(); ++n) {
    const double sum = weights.row(n).sum();
    if (sum > 0) {
      weights.row(n) /= sum;
    } else {
      weights(n, 0) = 1;
    }
  }
}

}  // namespace

NodeWeights carry_through(const Character& character, const Cage& cage, const SparseMatrix& laplacian,
                          const SparseMatrix& springs, const NodeWeights& bone_share) {
  const double pull = kSkinPull * laplacian.diagonal().mean();
  const NodeWeights on_skin = skin_weights(character);
  NodeWeights right = bone_share;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t v = 0; v < cage.skin.size(); ++v) {
    const EmbeddedPoint& point = cage.skin[v];
    for (int a = 0; a < 4; ++a) {
      const int node = cage.mesh.tets(point.tet, a);
      right.row(node) += pull * point.weights[a] * on_skin.row(static_cast<Eigen::Index>(v));
      for (int b = 0; b < 4; ++b) {
        entries.emplace_back(node, cage.mesh.tets(point.tet, b), pull * point.weights[a] * point.weights[b]);
      }
    }
  }
  SparseMatrix matrix = sparse_matrix(laplacian.rows(), laplacian.rows(), entries);
  matrix += laplacian + springs;
  const SparseSolver factor(matrix);
  require(factor);
  NodeWeights weights = factor.solve(right);
  normalise(weights);
  return weights;
}

}  // namespace bodyopt::trainer
