#include "trainer/transfer/match_colours.h"

namespace bodyopt {

Positions place_colours(const Positions& rest) {
  const Eigen::RowVector3d low = rest.colwise().minCoeff(), size = rest.colwise().maxCoeff() - low;
  Positions colours(rest.rows(), 3);
  for (Eigen::Index v = 0; v < rest.rows(); ++v) {
    for (int i = 0; i < 3; ++i) colours(v, i) = size[i] > 0 ? 0.05 + 0.75 * (rest(v, i) - low[i]) / size[i] : 0.4;
  }
  return colours;
}

Positions matched_colours(const Correspondence& correspondence, const Positions& colours) {
  Positions result = Positions::Zero(correspondence.target.rows(), 3);
  for (Eigen::Index v = 0; v < result.rows(); ++v) {
    const SkinPoint& at = correspondence.at[static_cast<std::size_t>(v)];
    for (int k = 0; k < 3; ++k) result.row(v) += at.weights[k] * colours.row(at.vertices[static_cast<std::size_t>(k)]);
  }
  return result;
}

}  // namespace bodyopt
