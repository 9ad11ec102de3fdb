// Which features explain what a region does.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace bodyopt {

struct SelectedFeature {
  std::uint32_t column;
  double gain;  // the share of the targets' energy that it explains beyond those before it
};

// Columns of `features` (N x F, standardised, less their values at rest) in the order in which each explains most of
// what is left of the targets (N x K) in a linear fit: orthogonal matching pursuit (Pati et al. 1993) for several
// targets. At most `limit`; none that earlier ones tell already, or that explains no more than features that have
// nothing to do with the targets may by chance. Of `deliberate` columns, ascending, somebody made the frames that tell
// of them: chance is no concern.
std::vector<SelectedFeature> select_features(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets,
                                             std::size_t limit, std::span<const Eigen::Index> deliberate = {});

}  // namespace bodyopt
