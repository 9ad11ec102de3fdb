#include "trainer/train/fit/surface_curves.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <string>

#include "base/linear_algebra.h"
#include "base/spread_evenly.h"
#include "geometry/extent.h"
#include "geometry/laplacian.h"
#include "geometry/nearest_skin.h"
#include "geometry/vertex_normals.h"
#include "trainer/train/fit/groundwork.h"

namespace bodyopt {
namespace {

using Eigen::Index;

// Parts of the character's longest extent: 20 cm and 5 cm of 1.8 m.
constexpr double kLength = 0.11, kApart = 0.028;

// What a ridge-penalised linear map of all features leaves of the un-posed motion, mean over frames.
struct LeftMotion {
  Eigen::VectorXd left;  // V, square metres
  double moved = 0;      // of all vertices, with what the map explains
};

// Runs of frames are fitted and measured in turns.
LeftMotion left_by_linear_map(const SampleSet& set, const Groundwork& ground) {
  constexpr std::size_t kMostFrames = 800, kRun = 10;
  constexpr double kPenalty = 1e-2;
  const std::vector<std::size_t> frames = spread_evenly(set.train.size(), kMostFrames);
  std::vector<std::uint32_t> all(ground.order.size());
  std::iota(all.begin(), all.end(), 0u);
  const Displacements motion = ground.shapes("train: surface curves", frames, all).displacements;
  const Eigen::MatrixXd features =
      ground.features.values(frames, Eigen::all).rowwise() - Eigen::RowVectorXd(ground.features.rest);
  std::vector<Index> fitted, measured;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    (n / kRun % 2 == 0 || frames.size() <= kRun ? fitted : measured).push_back(static_cast<Index>(n));
  }
  if (measured.empty()) measured = fitted;
  const Eigen::MatrixXd x = features(fitted, Eigen::all);
  Eigen::MatrixXd normal = x.transpose() * x;
  normal.diagonal().array() += kPenalty * static_cast<double>(x.rows());
  const Eigen::MatrixXf prediction =
      (features(measured, Eigen::all) * Cholesky(normal).solve(x.transpose())).cast<float>();
  const Displacements left = motion(measured, Eigen::all) - prediction * motion(fitted, Eigen::all);
  const Eigen::RowVectorXd squares = left.cast<double>().colwise().squaredNorm() / static_cast<double>(left.rows());
  const Eigen::VectorXd per_vertex =
      Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>(squares.data(), squares.size() / 3, 3)
          .rowwise()
          .sum();
  return {per_vertex, motion(measured, Eigen::all).cast<double>().squaredNorm() / static_cast<double>(left.rows())};
}

// The direction of the bone that begins at a joint, or ends there; zero for a joint alone.
Eigen::Vector3d bone_direction(const Skeleton& skeleton, std::uint32_t joint) {
  const auto place = [&](std::size_t j) { return Eigen::Vector3d(bind_place(skeleton, j).data()); };
  Eigen::Vector3d longest = Eigen::Vector3d::Zero();
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    if (skeleton.joints[j].parent != static_cast<int>(joint)) continue;
    const Eigen::Vector3d bone = place(j) - place(joint);
    if (bone.norm() > longest.norm()) longest = bone;
  }
  const int parent = skeleton.joints[joint].parent;
  if (longest.isZero() && parent >= 0) longest = place(joint) - place(static_cast<std::size_t>(parent));
  return longest;
}

class CurveMaker {
 public:
  // `character`: must outlive this.
  explicit CurveMaker(const Character& character)
      : character_(character),
        length_(kLength * longest_extent(character.vertices)),
        nearest_(character.vertices, character.triangles),
        normals_(vertex_normals(character.vertices, character.triangles)) {}

  Muscle along(Index vertex, const std::string& name) const { return curve(vertex, direction(vertex), name); }
  Muscle across(Index vertex, const std::string& name) const {
    return curve(vertex, normal(vertex).cross(direction(vertex)), name);
  }

 private:
  Eigen::Vector3d normal(Index vertex) const { return normals_.row(vertex).transpose().normalized(); }

  Eigen::Vector3d direction(Index vertex) const {
    const Eigen::Vector3d n = normal(vertex);
    const std::uint32_t joint = character_.weights[static_cast<std::size_t>(vertex)].front().joint;
    const Eigen::Vector3d bone = bone_direction(character_.skeleton, joint);
    const Eigen::Vector3d tangent = bone - bone.dot(n) * n;
    return tangent.norm() > 0.1 * bone.norm() ? tangent.normalized() : n.unitOrthogonal();
  }

  Muscle curve(Index vertex, const Eigen::Vector3d& direction, const std::string& name) const {
    std::vector<MusclePoint> path;
    const Eigen::Vector3d middle = character_.vertices.row(vertex).transpose();
    for (const double t : {-0.5, -0.25, 0.0, 0.25, 0.5}) {
      const SkinPoint point = nearest_(middle + t * length_ * direction);
      Index corner = 0;
      point.weights.maxCoeff(&corner);
      const std::uint32_t joint = character_.weights[point.vertices[static_cast<std::size_t>(corner)]].front().joint;
      path.push_back({joint, {point.position.x(), point.position.y(), point.position.z()}});
    }
    return surface_curve(name, std::move(path));
  }

  const Character& character_;
  double length_;
  NearestSkin nearest_;
  Positions normals_;
};

}  // namespace

std::vector<Muscle> surface_curves(const SampleSet& set, const TrainOptions& options) {
  check_samples(set);
  const Groundwork ground(set, options);
  const Character& character = ground.ordered;
  const double apart = kApart * longest_extent(character.vertices);
  Eigen::VectorXd left =
      smoothed(character.vertices, character.triangles, left_by_linear_map(set, ground).left, 0.5 * apart);
  const double least = 1e-3 * left.maxCoeff();
  const CurveMaker maker(character);
  std::vector<Muscle> curves;
  for (int k = 1; k <= options.surface_curves; ++k) {
    Index worst = 0;
    if (!(left.maxCoeff(&worst) > least)) break;
    const std::string name = "surface " + std::to_string(k);
    curves.push_back(maker.along(worst, name + " along"));
    curves.push_back(maker.across(worst, name + " across"));
    const Positions away = character.vertices.rowwise() - character.vertices.row(worst);
    left.array() *= 1 - (away.rowwise().squaredNorm().array() / (-2 * apart * apart)).exp();
  }
  return curves;
}

int needed_surface_curves(const SampleSet& set, const TrainOptions& options) {
  constexpr std::size_t kFewest = 80;
  constexpr int kPairs = 40;
  constexpr double kLeft = 1.0 / 3, kNoMotion = 1e-4;  // the latter of the longest extent; less is no motion
  if (!set.muscles.empty() || set.train.size() < kFewest || set.train.size() > kFewFrames) return 0;
  check_samples(set);
  const Groundwork ground(set, options);
  const LeftMotion motion = left_by_linear_map(set, ground);
  const double still = kNoMotion * longest_extent(ground.ordered.vertices);
  if (motion.moved < still * still * static_cast<double>(motion.left.size())) return 0;
  return motion.left.sum() > kLeft * kLeft * motion.moved ? kPairs : 0;
}

}  // namespace bodyopt
