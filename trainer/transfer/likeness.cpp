#include "trainer/transfer/likeness.h"

#include <algorithm>
#include <cmath>

#include "geometry/laplacian.h"
#include "trainer/transfer/joint_shares.h"
#include "trainer/transfer/table_rows.h"

namespace bodyopt {
namespace {

double mean_by_area(const Basis& basis, const Eigen::VectorXd& values) {
  const Eigen::VectorXd areas = lumped_areas(rows_of(basis.mesh.rest), rows_of(basis.mesh.triangles));
  return values.dot(areas) / areas.sum();
}

}  // namespace

double likeness(const TransferPair& pair) {
  const Basis &source = pair.source, &target = pair.target;
  const SkeletonMatch& match = pair.match;
  const Correspondence& skins = pair.correspondence;
  const double skin = 0.5 * (mean_by_area(source, skins.source_alike) + mean_by_area(target, skins.alike)),
               of_source = mean_by_area(source, share_of_matched(source, match.target_joint)),
               of_target = mean_by_area(target, share_of_matched(target, match.source_joint));
  return skin * std::max(of_source, of_target) * std::exp(-match.other_proportions * match.other_proportions);
}

}  // namespace bodyopt
