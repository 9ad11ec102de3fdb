#include "trainer/transfer/match_colours.h"

#include "base/parallel.h"

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

Eigen::VectorXd source_confidence(const Correspondence& correspondence, const Triangles& triangles) {
  const NearestSkin nearest(correspondence.target, triangles);
  Eigen::VectorXd result = Eigen::VectorXd::Zero(correspondence.fitted.rows());
  parallel_for(static_cast<std::size_t>(result.size()), [&](std::size_t v) {
    const auto row = static_cast<Eigen::Index>(v);
    const SkinPoint at = nearest(correspondence.fitted.row(row).transpose());
    for (int k = 0; k < 3; ++k) {
      result[row] += at.weights[k] * correspondence.confidence[at.vertices[static_cast<std::size_t>(k)]];
    }
  });
  return result;
}

}  // namespace bodyopt
