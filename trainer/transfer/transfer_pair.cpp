#include "trainer/transfer/transfer_pair.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "geometry/laplacian.h"
#include "geometry/table_rows.h"
#include "trainer/train/skinning/ddm_basis.h"
#include "trainer/transfer/joint_warp.h"

namespace bodyopt {
namespace {

// As the source was smoothed, where it says so; otherwise the defaults.
TrainOptions smoothing_of(const Basis& source, double size) {
  TrainOptions options;
  const auto text = source.metadata.find("provenance");
  if (text == source.metadata.end()) return options;
  const Json told = Json::parse(text->second, nullptr, false);
  if (!told.is_object()) return options;
  const auto radius = told.find("smoothing_radius_m"), steps = told.find("smoothing_steps");
  if (radius != told.end() && radius->is_number() && radius->get<double>() > 0) {
    options.smoothing_radius = size * radius->get<double>();
  }
  if (steps != told.end() && steps->is_number_integer() && steps->get<int>() > 0 && steps->get<int>() <= 1000) {
    options.smoothing_steps = steps->get<int>();
  }
  return options;
}

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

TransferPair::TransferPair(const Basis& from, const Character& target_character, const TransferOptions& options)
    : source(from),
      match(match_skeletons(from.skeleton, target_character.skeleton, options.joint_map)),
      target(build_ddm_basis(target_character, smoothing_of(from, match.size))),
      correspondence(match_skins(from, target, match, options.markers)),
      skin(from, target, correspondence, options.size) {}

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
