#include "trainer/transfer/transfer_parts.h"

#include <algorithm>
#include <cmath>

#include "geometry/laplacian.h"
#include "geometry/table_rows.h"
#include "trainer/transfer/joint_warp.h"

namespace bodyopt {
namespace {

constexpr double kSureMean = 0.7;        // of the confidence of a part
constexpr double kOtherBuild = 2;        // times as large
constexpr double kUnevenStretch = 0.35;  // of the logarithm

// Of every vertex the column with the largest share.
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

}  // namespace bodyopt
