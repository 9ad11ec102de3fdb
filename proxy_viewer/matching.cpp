#include "proxy_viewer/matching.h"

#include "trainer/transfer/match_colours.h"
#include "trainer/transfer/match_skeletons.h"
#include "trainer/transfer/table_rows.h"
#include "trainer/transfer/transfer_parts.h"

namespace bodyopt {
namespace {

std::vector<float> floats(const Eigen::MatrixXd& rows) {
  const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> values = rows.cast<float>();
  return {values.data(), values.data() + values.size()};
}

MatchRow row_of(const Basis& source, const Basis& target, const SkeletonMatch& match,
                const Correspondence& correspondence) {
  MatchRow row{correspondence.same_topology, correspondence.mean_confidence(), match.size, {}};
  for (const TransferPart& part : transfer_parts(source, target, match, correspondence)) {
    row.parts.push_back({part.joint, part.confidence, part.size, part.unevenness, part.breaks_assumption});
  }
  return row;
}

}  // namespace

void Matching::look() {
  if (controls_.settings.compare.match == MatchView::none || scene_.cast().size() < 2) return;
  if (row_ && controls_.marking.pairs == markers_) return;
  try {
    match();
  } catch (...) {
    controls_.settings.compare.match = MatchView::none;
    throw;
  }
}

void Matching::match() {
  forget();
  const Basis &source = scene_.cast()[0]->finest_basis(), &target = scene_.cast()[1]->finest_basis();
  std::vector<SkinMarker> markers;
  for (const MarkedPair& pair : controls_.marking.pairs) markers.push_back({pair.of_lead, pair.of_second});
  const SkeletonMatch skeletons = match_skeletons(source.skeleton, target.skeleton, "");
  const Correspondence found = match_skins(source, target, skeletons, markers);
  const auto upload = [&](const Eigen::MatrixXd& rows) { return vulkan::upload(*device_, floats(rows), "a match"); };
  const Positions places = place_colours(rows_of(source.mesh.rest));
  const Eigen::VectorXd of_source = source_confidence(found, rows_of(target.mesh.triangles));
  scene_.show_match(
      MatchedSkins{{upload(places), upload(matched_colours(found, places))},
                   {upload((1 - of_source.array()).matrix()), upload((1 - found.confidence.array()).matrix())}});
  row_ = row_of(source, target, skeletons, found);
  markers_ = controls_.marking.pairs;
}

void Matching::forget() {
  row_.reset();
  scene_.show_match(std::nullopt);
}

void Matching::describe(Snapshot& snapshot) const {
  snapshot.match = controls_.settings.compare.match == MatchView::none ? std::nullopt : row_;
}

}  // namespace bodyopt
