#include "trainer/simulate/node_weights.h"

#include <Eigen/SparseCholesky>

#include "runtime/basis/error.h"

namespace bodyopt {

NodeWeights carry_inwards(const Character& character, const SparseMatrix& laplacian, const SparseMatrix& springs,
                          const NodeWeights& bone_share) {
  const Eigen::Index skin = character.vertices.rows(), inside = laplacian.rows() - skin;
  NodeWeights weights = NodeWeights::Zero(laplacian.rows(), static_cast<Eigen::Index>(character.skeleton.size()));
  for (std::size_t v = 0; v < character.weights.size(); ++v) {
    for (const JointWeight& w : character.weights[v]) {
      weights(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(w.joint)) = w.weight;
    }
  }
  if (inside > 0) {
    const SparseMatrix matrix = laplacian + springs;
    const Eigen::SimplicialLDLT<SparseMatrix> factor(matrix.bottomRightCorner(inside, inside));
    if (factor.info() != Eigen::Success)
      throw Error(ErrorKind::mismatch, "the tetrahedra are too flat to carry weights");
    const SparseMatrix to_skin = matrix.bottomLeftCorner(inside, skin);
    for (Eigen::Index j = 0; j < weights.cols(); ++j) {
      const Eigen::VectorXd right = bone_share.col(j).tail(inside) - to_skin * weights.col(j).head(skin);
      weights.col(j).tail(inside) = factor.solve(right);
    }
  }
  weights = weights.cwiseMax(0);
  for (Eigen::Index n = 0; n < weights.rows(); ++n) {
    const double sum = weights.row(n).sum();
    if (sum > 0) {
      weights.row(n) /= sum;
    } else {
      weights(n, 0) = 1;
    }
  }
  return weights;
}

}  // namespace bodyopt
