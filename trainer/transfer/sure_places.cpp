#include "trainer/transfer/sure_places.h"

#include "geometry/table_rows.h"
#include "trainer/transfer/joint_warp.h"

namespace bodyopt {

Positions sure_places(const TransferPair& pair) {
  const Correspondence& match = pair.correspondence;
  if (match.same_topology) return match.fitted;
  const Eigen::VectorXd confidence = source_confidence(match, rows_of(pair.target.mesh.triangles));
  const SmoothFill fill(rows_of(pair.source.mesh.rest), rows_of(pair.source.mesh.triangles),
                        rows_below(confidence, kSureConfidence));
  const Positions warped = warped_by_joints(pair.source, pair.target, pair.match);
  Eigen::MatrixXd moved = match.fitted - warped;
  fill(moved);
  return warped + moved;
}

}  // namespace bodyopt
