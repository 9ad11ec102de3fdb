#include "viewport/matching.h"

#include "geometry/mesh.h"
#include "trainer/transfer/correspondence.h"
#include "trainer/transfer/match_skeletons.h"
#include "trainer/transfer/transfer_basis.h"
#include "trainer/transfer/transfer_pair.h"

namespace bodyopt::viewport {
namespace {

std::vector<float> floats(const Eigen::MatrixXd& rows) {
  const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> values = rows.cast<float>();
  return {values.data(), values.data() + values.size()};
}

MatchRow row_of(const Basis& source, const Basis& target, const trainer::SkeletonMatch& match,
                const trainer::Correspondence& correspondence) {
  MatchRow row{correspondence.same_topology, correspondence.mean_confidence(), match.size, {}};
  for (const trainer::TransferPart& part : trainer::transfer_parts(source, target, match, correspondence)) {
    row.parts.push_back({part.joint, part.confidence, part.size, part.unevenness, part.breaks_assumption});
  }
  return row;
}

}  // namespace

void Matching::look() {
  if (controls_.settings.compare.match == shots::MatchView::none || scene_.cast().size() < 2) return;
  try {
    if (!row_ || controls_.marking.pairs != markers_) match();
    measure_volumes();
    look_through_clip();
  } catch (...) {
    controls_.settings.compare.match = shots::MatchView::none;
    throw;
  }
}

void Matching::match() {
  forget();
  const Basis &source = scene_.cast()[0]->finest_basis(), &target = scene_.cast()[1]->finest_basis();
  std::vector<trainer::SkinMarker> markers;
  for (const MarkedPair& pair : controls_.marking.pairs) markers.push_back({pair.of_lead, pair.of_second});
  const trainer::SkeletonMatch skeletons = trainer::match_as_carried(source.skeleton, target.skeleton, target.metadata);
  const trainer::Correspondence found = trainer::match_skins(source, target, skeletons, markers);
  const auto upload = [&](const Eigen::MatrixXd& rows) { return vulkan::upload(*device_, floats(rows), "a match"); };
  const Positions places = trainer::place_colours(rows_of(source.mesh.rest));
  const Eigen::VectorXd of_source = trainer::source_confidence(found, rows_of(target.mesh.triangles));
  scene_.show_match(
      MatchedSkins{{upload(places), upload(trainer::matched_colours(found, places))},
                   {upload((1 - of_source.array()).matrix()), upload((1 - found.confidence.array()).matrix())}});
  row_ = row_of(source, target, skeletons, found);
  markers_ = controls_.marking.pairs;
}

void Matching::measure_volumes() {
  if (controls_.playback.playing()) {
    row_->volumes.reset();
    measured_ = {};
    return;
  }
  std::array<double, 2> volumes = row_->volumes.value_or(std::array{1.0, 1.0});
  for (std::size_t k = 0; k < 2; ++k) {
    Actor& body = *scene_.cast()[k];
    const int frame = controls_.playback.frame();
    const Pose pose = scene_.pose_at(body, frame, controls_);
    if (same(measured_[k], {&pose, 1})) continue;
    volumes[k] = trainer::relative_volume(body.finest_basis().mesh, body.measure(SkinMethod::full, pose, frame));
    measured_[k] = {pose};
  }
  row_->volumes = volumes;
}

void Matching::look_through_clip() {
  const Actor& second = *scene_.cast()[1];
  if (looked_through_ == second.files().clip) return;
  row_->to_simulate = trainer::frames_to_simulate(second.finest_basis(), second.clip());
  looked_through_ = second.files().clip;
}

void Matching::forget() {
  row_.reset();
  measured_ = {};
  looked_through_.reset();
  scene_.show_match(std::nullopt);
}

void Matching::describe(Snapshot& snapshot) const {
  snapshot.match = controls_.settings.compare.match == shots::MatchView::none ? std::nullopt : row_;
}

}  // namespace bodyopt::viewport
