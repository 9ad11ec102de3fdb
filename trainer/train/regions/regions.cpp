#include "trainer/train/regions/regions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "base/linear_algebra.h"
#include "base/parallel.h"
#include "geometry/surface_distance.h"
#include "runtime/host/rig.h"
#include "trainer/train/features/features.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Beyond its vertices, a region then costs 150 bytes for each of them at most; small skins may have a few.
constexpr Index kVerticesPerRegion = 300, kFewestVerticesPerRegion = 40, kFewRegions = 8;

using Points = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Index seed_furthest_from_middle(const Points& points, const Eigen::VectorXd& mass) {
  Index seed = 0;
  const Eigen::RowVectorXd middle = points.colwise().mean();
  (points.rowwise() - middle).rowwise().squaredNorm().cwiseProduct(mass).maxCoeff(&seed);
  return seed;
}

// Labels of k-means clusters of the rows, which have a mass each, seeded by farthest-point sampling.
std::vector<Index> cluster(const Points& points, const Eigen::VectorXd& mass, Index count) {
  Points centres(count, points.cols());
  centres.row(0) = points.row(seed_furthest_from_middle(points, mass));
  Eigen::VectorXd nearest = (points.rowwise() - centres.row(0)).rowwise().squaredNorm();
  for (Index c = 1; c < count; ++c) {
    Index farthest = 0;
    nearest.cwiseProduct(mass).maxCoeff(&farthest);
    centres.row(c) = points.row(farthest);
    nearest = nearest.cwiseMin((points.rowwise() - centres.row(c)).rowwise().squaredNorm());
  }
  std::vector<Index> labels(static_cast<std::size_t>(points.rows()));
  constexpr int kRounds = 20;
  for (int round = 0; round < kRounds; ++round) {
    Points sums = Points::Zero(count, points.cols());
    Eigen::VectorXd sizes = Eigen::VectorXd::Zero(count);
    // |point - centre|^2 less |point|^2, which is the same for all centres
    MatrixXd distances = -2 * centres * points.transpose();
    distances.colwise() += centres.rowwise().squaredNorm();
    for (Index v = 0; v < points.rows(); ++v) {
      Index label = 0;
      distances.col(v).minCoeff(&label);
      labels[static_cast<std::size_t>(v)] = label;
      sums.row(label) += mass[v] * points.row(v);
      sizes[label] += mass[v];
    }
    for (Index c = 0; c < count; ++c) {
      if (sizes[c] > 0) centres.row(c) = sums.row(c) / sizes[c];
    }
  }
  return labels;
}

// Place and influences of every vertex, so that one unit is a notable difference in any of them. `patch`: metres.
Points descriptors(const Character& character, const std::vector<FeatureGroup>& groups, double patch) {
  Points points(character.vertices.rows(), 3 + static_cast<Index>(groups.size()));
  points.leftCols(3) = character.vertices / patch;
  for (std::size_t g = 0; g < groups.size(); ++g) points.col(3 + static_cast<Index>(g)) = groups[g].influence;
  return points;
}

// `left`: of every vertex; a group counts where most of what it moves is left.
Index region_count(const std::vector<FeatureGroup>& groups, const Eigen::VectorXd& left) {
  const auto vertices = static_cast<Index>(std::lround(left.sum()));
  double count = 0;
  for (const FeatureGroup& group : groups) {
    if (group.points.rows() == 0 || !(group.influence.maxCoeff() > 0.5 || !group.spans.empty())) continue;
    if (group.influence.dot(left) < 0.5 * group.influence.sum()) continue;
    count += group.spans.empty() ? 1 : 0.5;
  }
  const Index few = std::min(kFewRegions, vertices / kFewestVerticesPerRegion);
  const Index most = std::max({Index{1}, vertices / kVerticesPerRegion, few});
  return std::clamp<Index>(static_cast<Index>(std::ceil(count)), 1, most);
}

// Takes a ridge-penalised linear fit of the columns of `x` out of others.
class WithoutLinearFit {
 public:
  explicit WithoutLinearFit(const MatrixXd& x) : x_(x), factor_(ridged(x)) {}
  MatrixXd operator()(const MatrixXd& y) const { return y - x_ * factor_.solve(x_.transpose() * y); }

 private:
  static MatrixXd ridged(const MatrixXd& x) {
    MatrixXd normal = x.transpose() * x;
    normal.diagonal().array() += 1e-3 * static_cast<double>(x.rows());
    return normal;
  }

  const MatrixXd& x_;
  Cholesky factor_;
};

Positions fibre_points(const Basis& basis, std::uint32_t fibre) {
  const StrainTable& strain = basis.strain;
  const std::uint32_t begin = strain.fibre_begin[fibre], end = strain.fibre_begin[fibre + 1];
  Positions points(end - begin, 3);
  for (std::uint32_t p = begin; p < end; ++p) {
    const float* rest = basis.mesh.rest.data() + 3 * std::size_t{strain.vertices[strain.points[p].a]};
    points.row(p - begin) << double{rest[0]}, double{rest[1]}, double{rest[2]};
  }
  return points;
}

// How the joints move the skin: their smoothed weights.
std::vector<FeatureGroup> joint_groups(const Skeleton& skeleton, const std::vector<VertexMoments>& moments,
                                       const MatrixXd& features) {
  std::vector<FeatureGroup> groups;
  for (const std::uint32_t joint : feature_joints(skeleton)) {
    FeatureGroup group;
    group.features = varying_features(features, 9 * static_cast<std::uint32_t>(groups.size()), 9);
    group.points = Eigen::RowVector3d(bind_place(skeleton, joint).data());
    group.influence = Eigen::VectorXd::Zero(static_cast<Index>(moments.size()));
    for (std::size_t v = 0; v < moments.size(); ++v) {
      for (const JointMoments& m : moments[v].joints) {
        if (m.joint == joint) group.influence[static_cast<Index>(v)] = m.omega;
      }
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

Eigen::VectorXd energy_per_vertex(const Eigen::RowVectorXf& columns) {
  return Eigen::Map<const Eigen::Matrix<float, 3, Eigen::Dynamic>>(columns.data(), 3, columns.size() / 3)
      .cast<double>()
      .colwise()
      .sum();
}

// V x G: the energy of |q^T motion|^2 for each of the matrices q, over that of the motion (N x 3V).
MatrixXd shares_of_energy(const Displacements& motion, const std::vector<MatrixXd>& matrices) {
  constexpr Index kChunk = 256;  // vertices
  Index rows = 0;
  for (const MatrixXd& q : matrices) rows += q.cols();
  Eigen::MatrixXf all(rows, motion.rows());
  for (Index begin = 0; const MatrixXd& q : matrices) {
    all.middleRows(begin, q.cols()) = q.transpose().cast<float>();
    begin += q.cols();
  }
  const Index vertices = motion.cols() / 3;
  MatrixXd shares(vertices, static_cast<Index>(matrices.size()));
  parallel_for(static_cast<std::size_t>((vertices + kChunk - 1) / kChunk), [&](std::size_t chunk) {
    const Index first = static_cast<Index>(chunk) * kChunk, count = std::min(kChunk, vertices - first);
    const Eigen::MatrixXf squares = (all * motion.middleCols(3 * first, 3 * count)).cwiseAbs2();
    for (Index g = 0, begin = 0; g < shares.cols(); ++g) {
      const Index size = matrices[static_cast<std::size_t>(g)].cols();
      shares.col(g).segment(first, count) = energy_per_vertex(squares.middleRows(begin, size).colwise().sum());
      begin += size;
    }
  });
  const Eigen::VectorXd energy = energy_per_vertex(motion.colwise().squaredNorm());
  const double floor = 0.1 * energy.mean() + std::numeric_limits<double>::min();
  shares.array().colwise() /= energy.array() + floor;
  return shares;
}

// How the muscles move the skin: beyond a linear fit of the joints. `first`: feature index of the first strain.
std::vector<FeatureGroup> muscle_groups(const Basis& basis, const std::vector<Muscle>& muscles,
                                        const MatrixXd& features, Index first, const Displacements& displacements) {
  const MatrixXd joints = features.leftCols(first);
  const Index fibres = basis.strain.fibre_count();
  const WithoutLinearFit without_joints(joints);
  const MatrixXd strains = without_joints(features.middleCols(first, fibres));
  const std::vector<std::uint32_t> group_joints = feature_joints(basis.skeleton);
  const std::vector<std::size_t> muscle_of_fibre = fibre_muscles(basis.strain, muscles);
  std::vector<FeatureGroup> groups;
  std::vector<MatrixXd> regressors;
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    FeatureGroup group;
    std::vector<Index> columns;
    for (std::uint32_t fibre = 0; fibre < fibres; ++fibre) {
      if (muscle_of_fibre[fibre] != m) continue;
      const auto own = varying_features(features, static_cast<std::uint32_t>(first) + fibre, 1);
      group.features.insert(group.features.end(), own.begin(), own.end());
      columns.push_back(fibre);
      const Positions line = fibre_points(basis, fibre);
      group.points.conservativeResize(group.points.rows() + line.rows(), 3);
      group.points.bottomRows(line.rows()) = line;
    }
    if (group.features.empty()) continue;
    // q^T (Y - its linear fit) = (q - its linear fit)^T Y: the fit is symmetric, and q is so much smaller.
    regressors.push_back(without_joints(orthonormal_basis(strains(Eigen::all, columns), 1e-3)));
    for (const std::uint32_t joint : spanned_joints(basis.skeleton, muscles[m])) {
      const auto place = std::find(group_joints.begin(), group_joints.end(), joint);
      if (place != group_joints.end()) group.spans.push_back(static_cast<std::size_t>(place - group_joints.begin()));
    }
    groups.push_back(std::move(group));
  }
  const MatrixXd shares = shares_of_energy(displacements, regressors);
  for (std::size_t g = 0; g < groups.size(); ++g) groups[g].influence = shares.col(static_cast<Index>(g));
  return groups;
}

// Regions of what is `left` of every vertex.
std::vector<RegionWeights> automatic_regions(const Character& character, const std::vector<FeatureGroup>& groups,
                                             const Eigen::VectorXd& left) {
  const Index vertices = character.vertices.rows(), count = region_count(groups, left);
  const double area = (lumped_areas(character.vertices, character.triangles).array() * left.array()).sum();
  const double patch = std::sqrt(area / static_cast<double>(count));
  const std::vector<Index> labels = cluster(descriptors(character, groups, patch), left, count);
  MatrixXd weights = MatrixXd::Zero(vertices, count);
  for (Index v = 0; v < vertices; ++v) weights(v, labels[static_cast<std::size_t>(v)]) = 1;
  weights = smoothed(character.vertices, character.triangles, weights, 0.25 * patch);
  weights = (weights.array() < kNegligibleRegionWeight).select(0, weights);
  weights.array().colwise() /= weights.rowwise().sum().array().eval();
  weights.array().colwise() *= left.array();

  std::vector<RegionWeights> regions;
  for (Index c = 0; c < count; ++c) regions.push_back(region_of("", weights.col(c)));
  drop_negligible(regions);
  return regions;
}

void name_after_joints(const Character& character, std::vector<RegionWeights>& regions) {
  std::set<std::string> taken;
  for (const RegionWeights& region : regions) taken.insert(region.name);
  for (RegionWeights& region : regions) {
    if (!region.name.empty()) continue;
    const std::string joint = joints_of(character, region).front();
    region.name = joint;
    for (int k = 2; !taken.insert(region.name).second; ++k) region.name = joint + " " + std::to_string(k);
  }
}

double distance_to(const Character& character, const RegionWeights& region, const FeatureGroup& group) {
  if (group.points.rows() == 0) return 0;
  const double core = std::min(0.5, *std::max_element(region.weights.begin(), region.weights.end()));
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t v = 0; v < region.vertices.size(); ++v) {
    if (region.weights[v] < core) continue;
    const Eigen::RowVector3d here = character.vertices.row(region.vertices[v]);
    nearest = std::min(nearest, (group.points.rowwise() - here).rowwise().squaredNorm().minCoeff());
  }
  return std::sqrt(nearest);
}

double mean_influence(const RegionWeights& region, const FeatureGroup& group) {
  return mean_over(region, [&](std::size_t k) { return group.influence[region.vertices[k]]; });
}

}  // namespace

std::vector<std::uint32_t> spanned_joints(const Skeleton& skeleton, const Muscle& muscle) {
  std::vector<int> points_below(skeleton.size(), 0);
  for (const MusclePoint& point : muscle.path) {
    for (int j = static_cast<int>(point.joint); j >= 0; j = skeleton.joints[static_cast<std::size_t>(j)].parent) {
      ++points_below[static_cast<std::size_t>(j)];
    }
  }
  std::vector<std::uint32_t> joints;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const bool between = points_below[j] > 0 && points_below[j] < static_cast<int>(muscle.path.size());
    if (between) joints.push_back(static_cast<std::uint32_t>(j));
  }
  return joints;
}

std::vector<FeatureGroup> make_feature_groups(const Basis& basis, const std::vector<VertexMoments>& moments,
                                              const std::vector<Muscle>& muscles, const MatrixXd& features,
                                              const Displacements& displacements) {
  const Index joint_features = joint_feature_count(basis.skeleton);
  std::vector<FeatureGroup> groups = joint_groups(basis.skeleton, moments, features);
  for (FeatureGroup& group : muscle_groups(basis, muscles, features, joint_features, displacements)) {
    groups.push_back(std::move(group));
  }
  for (Index k = joint_features + basis.strain.fibre_count(); k < features.cols(); ++k) {
    FeatureGroup& control = groups.emplace_back();
    control.features = varying_features(features, static_cast<std::uint32_t>(k), 1);
    control.influence = Eigen::VectorXd::Ones(static_cast<Index>(moments.size()));
  }
  return groups;
}

std::vector<std::string> joints_of(const Character& character, const RegionWeights& region) {
  constexpr double kNotable = 0.05;
  std::map<std::uint32_t, double> shares;
  double all = 0;
  for (std::size_t v = 0; v < region.vertices.size(); ++v) {
    for (const JointWeight& w : character.weights[region.vertices[v]]) {
      shares[w.joint] += region.weights[v] * w.weight;
      all += region.weights[v] * w.weight;
    }
  }
  std::vector<std::pair<double, std::uint32_t>> order;
  for (const auto& [joint, share] : shares) order.emplace_back(-share, joint);
  std::sort(order.begin(), order.end());
  std::vector<std::string> names;
  for (const auto& [share, joint] : order) {
    if (names.empty() || -share >= kNotable * all) names.push_back(character.skeleton.joints[joint].name);
  }
  return names;
}

std::vector<RegionWeights> make_regions(const Character& character, const std::vector<FeatureGroup>& groups,
                                        const std::vector<RegionWeights>& painted) {
  const Index vertices = character.vertices.rows();
  const Eigen::VectorXd rest = 1 - sum_of_weights(painted, vertices).array();
  const Eigen::VectorXd left = (rest.array() < kNegligibleRegionWeight).select(0, rest);
  std::vector<RegionWeights> regions = painted;
  if (left.maxCoeff() > 0) {
    for (RegionWeights& region : automatic_regions(character, groups, left)) {
      if (!region.vertices.empty()) regions.push_back(std::move(region));
    }
  }
  scale_to_one(regions, vertices);
  // Neighbours in runtime order lie near each other: they share the most vertices.
  std::ranges::sort(regions, {}, &RegionWeights::vertices);
  name_after_joints(character, regions);
  return regions;
}

std::vector<std::uint32_t> region_features(const Character& character, const RegionWeights& region,
                                           const std::vector<FeatureGroup>& groups, double radius) {
  constexpr double kNotable = 0.05;  // mean influence
  std::vector<bool> chosen(groups.size(), false);
  std::size_t closest = 0;
  double closest_distance = std::numeric_limits<double>::infinity();
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (groups[g].features.empty()) continue;
    const double distance = distance_to(character, region, groups[g]);
    const bool notable = mean_influence(region, groups[g]) > kNotable;
    chosen[g] = chosen[g] || distance <= radius || notable;
    if (distance <= 0.5 * radius || notable) {
      for (const std::size_t joint : groups[g].spans) chosen[joint] = true;
    }
    if (distance < closest_distance) {
      closest_distance = distance;
      closest = g;
    }
  }
  if (!groups.empty()) chosen[closest] = true;
  std::vector<std::uint32_t> features;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (chosen[g]) features.insert(features.end(), groups[g].features.begin(), groups[g].features.end());
  }
  return features;
}

}  // namespace bodyopt::trainer
