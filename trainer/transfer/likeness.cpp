#include "trainer/transfer/likeness.h"

#include <algorithm>
#include <cmath>

#include "geometry/laplacian.h"
#include "geometry/table_rows.h"
#include "trainer/transfer/joint_shares.h"

namespace bodyopt {
namespace {

double mean_by_area(const Basis& basis, const Eigen::VectorXd& values) {
  const Eigen::VectorXd areas = lumped_areas(rows_of(basis.mesh.rest), rows_of(basis.mesh.triangles));
  return values.dot(areas) / areas.sum();
}

double other_proportions_of_skin(const Basis& source, const Positions& fitted) {
  const Triangles triangles = rows_of(source.mesh.triangles);
  const Eigen::ArrayXd areas = lumped_areas(rows_of(source.mesh.rest), triangles),
                       logs = 0.5 * (lumped_areas(fitted, triangles).array() / areas).log();
  const double mean = (areas * logs).sum() / areas.sum();
  return std::sqrt((areas * (logs - mean).square()).sum() / areas.sum());
}

}  // namespace

double likeness(const TransferPair& pair) {
  const Basis &source = pair.source, &target = pair.target;
  const Correspondence& skins = pair.correspondence;
  const double alike = 0.5 * (mean_by_area(source, skins.source_alike) + mean_by_area(target, skins.alike)),
               held = std::max(mean_by_area(source, share_of_matched(source, pair.match.target_joint)),
                               mean_by_area(target, share_of_matched(target, pair.match.source_joint))),
               bones = pair.match.other_proportions, skin = other_proportions_of_skin(source, skins.fitted);
  return alike * held * held * std::exp(-bones * bones - skin * skin);
}

}  // namespace bodyopt
