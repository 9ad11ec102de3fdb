#include "trainer/transfer/transfer_pair.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/mesh.h"
#include "geometry/surface_distance.h"
#include "trainer/train/skinning/ddm.h"
#include "trainer/train/skinning/provenance.h"

namespace bodyopt::trainer {
namespace {

// Smooths as the source was, where it says so; otherwise by the defaults.
TrainOptions smoothing_of(const Basis& source, double size) {
  TrainOptions options;
  const std::optional<Provenance> trained = read_provenance(source.metadata, "the source");
  if (!trained) return options;
  options.smoothing_radius = size * trained->options.smoothing_radius;
  options.smoothing_steps = std::max(1, trained->options.smoothing_steps);
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

constexpr double kSureMean = 0.7;        // of the confidence of a part
constexpr double kOtherBuild = 2;        // times as large
constexpr double kUnevenStretch = 0.35;  // of the logarithm

// The column with the largest share of every vertex.
std::vector<Eigen::Index> holders(const JointShares& shares) {
  std::vector<Eigen::Index> joints(static_cast<std::size_t>(shares.rows()), 0);
  for (Eigen::Index v = 0; v < shares.rows(); ++v) shares.row(v).maxCoeff(&joints[static_cast<std::size_t>(v)]);
  return joints;
}

struct LogSizes {
  double count = 0, sum = 0, squares = 0;
  double mean() const { return sum / count; }
  double deviation() const { return std::sqrt(std::max(0.0, squares / count - mean() * mean())); }
};

std::vector<LogSizes> log_sizes(const Basis& source, const SkeletonMatch& match, const Positions& fitted) {
  const MeshTable& mesh = source.mesh;
  const Triangles triangles = rows_of(mesh.triangles);
  const Eigen::ArrayXd own = lumped_areas(fitted, triangles), other = lumped_areas(rows_of(mesh.rest), triangles);
  const Eigen::ArrayXd logs = 0.5 * (own / other).log();
  std::vector<LogSizes> sizes(source.skeleton.size());
  const std::vector<Eigen::Index> joints = holders(source_joint_shares(source, match));
  for (Eigen::Index v = 0; v < logs.size(); ++v) {
    if (!std::isfinite(logs[v])) continue;  // no area on one side
    LogSizes& part = sizes[static_cast<std::size_t>(joints[static_cast<std::size_t>(v)])];
    part.count += 1;
    part.sum += logs[v];
    part.squares += logs[v] * logs[v];
  }
  return sizes;
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

std::vector<TransferPart> transfer_parts(const Basis& source, const Basis& target, const SkeletonMatch& match,
                                         const Correspondence& correspondence) {
  const std::vector<LogSizes> sizes = log_sizes(source, match, correspondence.fitted);
  std::vector<TransferPart> parts(sizes.size());
  const std::vector<Eigen::Index> joints = holders(target_joint_shares(target, match));
  std::vector<double> areas(parts.size(), 0);
  for (TransferPart& part : parts) part.confidence = 0;
  for (std::size_t v = 0; v < joints.size(); ++v) {
    const auto j = static_cast<std::size_t>(joints[v]);
    const double area = correspondence.area[static_cast<Eigen::Index>(v)];
    parts[j].confidence += area * correspondence.confidence[static_cast<Eigen::Index>(v)];
    ++parts[j].vertices;
    areas[j] += area;
  }
  std::vector<TransferPart> list;
  for (std::size_t j = 0; j < parts.size(); ++j) {
    TransferPart& part = parts[j];
    if (part.vertices == 0 || sizes[j].count == 0) continue;
    part.joint = source.skeleton.joints[j].name;
    part.confidence /= areas[j];
    part.size = std::exp(sizes[j].mean());
    part.unevenness = sizes[j].deviation();
    const double build = std::abs(std::log(part.size / match.size));
    part.breaks_assumption =
        part.confidence < kSureMean || build > std::log(kOtherBuild) || part.unevenness > kUnevenStretch;
    list.push_back(part);
  }
  std::ranges::stable_sort(list, {}, &TransferPart::confidence);
  return list;
}

}  // namespace bodyopt::trainer
