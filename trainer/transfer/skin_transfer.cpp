#include "trainer/transfer/skin_transfer.h"

#include "geometry/table_rows.h"

namespace bodyopt {

namespace {

// Vertices of the same number are the same points, however unlike they look.
std::vector<int> unsure_vertices(const Correspondence& correspondence) {
  if (correspondence.same_topology) return {};
  return rows_below(correspondence.confidence, kSureConfidence);
}

}  // namespace

SkinTransfer::SkinTransfer(const Basis& source, const Basis& target, const Correspondence& correspondence,
                           TransferSize size)
    : correspondence_(correspondence),
      transfer_(rows_of(source.mesh.rest), correspondence.fitted, rows_of(source.mesh.triangles), size),
      fill_(correspondence.target, rows_of(target.mesh.triangles), unsure_vertices(correspondence)) {}

Positions SkinTransfer::operator()(const Positions& displacements) const {
  const Positions fitted = transfer_(displacements);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(correspondence_.target.rows(), 3);
  for (Eigen::Index v = 0; v < result.rows(); ++v) {
    const SkinPoint& at = correspondence_.at[static_cast<std::size_t>(v)];
    for (int k = 0; k < 3; ++k) {
      if (at.weights[k] != 0) result.row(v) += at.weights[k] * fitted.row(at.vertices[static_cast<std::size_t>(k)]);
    }
  }
  for (const int v : fill_.unknown()) result.row(v).setZero();  // a piece without a sure vertex does not move
  fill_(result);
  for (Eigen::Index v = 0; v < result.rows(); ++v) {
    const Quat& turn = correspondence_.rotation[static_cast<std::size_t>(v)];
    if (turn == Quat{0, 0, 0, 1}) continue;
    const Vec3 back = rotate(conjugate(turn), {result(v, 0), result(v, 1), result(v, 2)});
    result.row(v) << back[0], back[1], back[2];
  }
  return result;
}

}  // namespace bodyopt
