#include "trainer/train/features/features.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "assets/characters/joints_with_skin.h"
#include "base/linear_algebra.h"
#include "base/parallel.h"
#include "base/quantile.h"
#include "geometry/mesh.h"
#include "geometry/nearest_skin.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "runtime/cpu/kernels.h"
#include "runtime/host/rig.h"
#include "trainer/motion/attached_rig.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kLeastShown = 0.03;  // radians: an axis along which training moves less was not shown
constexpr double kUsualShare = 0.99;  // of the frames that cross-validation holds out

// A list for every joint that has features: itself, its parent and its children, as places in feature_joints().
std::vector<std::vector<std::uint32_t>> neighbourhoods(const Skeleton& skeleton) {
  const std::vector<JointFeatures> joints = joint_features_of(skeleton);
  const auto is_above = [&](const JointFeatures& one, const JointFeatures& other) {
    return other.above == one.joint || skeleton.joints[other.joint].parent == static_cast<int>(one.joint);
  };
  std::vector<std::vector<std::uint32_t>> result(joints.size());
  for (std::uint32_t a = 0; a < joints.size(); ++a) {
    for (std::uint32_t b = 0; b < joints.size(); ++b) {
      const bool near =
          joints[a].joint == joints[b].joint || is_above(joints[a], joints[b]) || is_above(joints[b], joints[a]);
      if (near) result[a].push_back(b);
    }
  }
  return result;
}

std::vector<Index> columns_of(const std::vector<std::uint32_t>& joints) {
  std::vector<Index> columns;
  for (const std::uint32_t joint : joints) {
    for (Index k = 0; k < 9; ++k) columns.push_back(9 * Index{joint} + k);
  }
  return columns;
}

// Rows are orthonormal axes along which the frames (N x F) hardly move.
MatrixXd axes_not_shown(const MatrixXd& frames) {
  const MatrixXd spread = frames.transpose() * frames / static_cast<double>(std::max<Index>(1, frames.rows()));
  const SymmetricEigen eigen = symmetric_eigen(spread);
  const Index count = (eigen.values.array() < kLeastShown * kLeastShown).count();
  return eigen.vectors.leftCols(count).transpose();
}

// The squared distance of the nine columns of each row from the range that others span with rest.
Eigen::VectorXd squared_excess(const MatrixXd& frames, const MatrixXd& shown) {
  const Eigen::RowVectorXd low = shown.colwise().minCoeff().cwiseMin(0), high = shown.colwise().maxCoeff().cwiseMax(0);
  const MatrixXd below = (-(frames.rowwise() - low)).cwiseMax(0), above = (frames.rowwise() - high).cwiseMax(0);
  return (below + above).rowwise().squaredNorm();
}

struct JointFrames {
  MatrixXd near;  // N x 9 neighbours
  MatrixXd own;   // N x 9
};

// How far each of the frames stands off what others showed, radians squared.
Eigen::VectorXd squared_distance(const JointFrames& frames, const JointFrames& shown) {
  return (frames.near * axes_not_shown(shown.near).transpose()).rowwise().squaredNorm() +
         squared_excess(frames.own, shown.own);
}

JointFrames some_of(const JointFrames& frames, const std::vector<Index>& rows) {
  return {frames.near(rows, Eigen::all), frames.own(rows, Eigen::all)};
}

double tolerance_of(const JointFrames& frames, const std::vector<int>& folds) {
  std::vector<double> distances;
  const int last = *std::max_element(folds.begin(), folds.end());
  for (int fold = 0; fold <= last; ++fold) {
    std::vector<Index> held_out, others;
    for (std::size_t n = 0; n < folds.size(); ++n) {
      if (folds[n] < 0) continue;
      (folds[n] == fold ? held_out : others).push_back(static_cast<Index>(n));
    }
    const Eigen::VectorXd some = squared_distance(some_of(frames, held_out), some_of(frames, others));
    distances.insert(distances.end(), some.begin(), some.end());
  }
  const double usual = distances.empty() ? 0 : quantile(distances, kUsualShare);
  return std::max(squared_distance(frames, frames).maxCoeff(), usual);
}

// The features, with joints seen from those that their skin hangs under.
std::vector<JointFeatures> attached_features(const Character& character, std::vector<JointFeatures> features) {
  const AttachedRig rig(character.skeleton, detached_joints(character));
  const std::vector<bool> of_all_skin = joints_of_all_skin(rig.attached(character));
  for (JointFeatures& of : features) {
    const std::uint32_t place = rig.places()[of.joint];
    const std::uint32_t above = rig.own_joints()[static_cast<std::size_t>(rig.skeleton().joints[place].parent)];
    if (common_joint(character.skeleton, of.joint, above) >= 0) of.above = above;
    if (of_all_skin[place]) of.above = of.joint;
  }
  return features;
}

constexpr double kSlides = 0.01;    // of the longest extent: less is rounding, or a bone of another length
constexpr double kAsARadian = 0.1;  // of the longest extent

// The places of those joints of `features` that some pose slides.
std::vector<JointFeatures> sliding_features(const Character& character, const std::vector<JointFeatures>& features,
                                            std::span<const Pose* const> poses) {
  const double extent = longest_extent(character.vertices);
  Skeleton skeleton = character.skeleton;
  skeleton.features = features;
  for (JointFeatures& of : skeleton.features) of.per_metre = 1;
  std::vector<double> most(features.size(), 0);  // metres
  for (const Pose* pose : poses) {
    const std::vector<float> slides = pose_rig(skeleton, *pose).joint_features;
    for (std::size_t k = 0; k < most.size(); ++k) {
      for (std::size_t i = 0; i < 3; ++i) most[k] = std::max(most[k], std::abs(double{slides[9 * k + i]}));
    }
  }
  std::vector<JointFeatures> sliding;
  for (std::size_t k = 0; k < most.size(); ++k) {
    if (most[k] < kSlides * extent) continue;
    sliding.push_back(features[k]);
    sliding.back().per_metre = 1 / (kAsARadian * extent);
  }
  return sliding;
}

// The deviation of a feature (radians, strain) counts as this at least. One that hardly moves in training says nothing,
// but its leaving the trained range must show.
constexpr double kLeastDeviation = 1e-3;

std::vector<float> strains_of(const Basis& basis, const StrainTable& fibres, const RigFrame& rig) {
  std::vector<float> positions(3 * fibres.vertices.size()), strains(fibres.fibre_count());
  cpu::strain_skin(basis.ddm, fibres, static_cast<std::uint32_t>(basis.skeleton.size()), rig.learned_skinning,
                   positions);
  cpu::strain_measure(fibres, positions, strains);
  return strains;
}

// Joint features, strains and controls of one pose, as they come.
std::vector<float> raw_features(const Basis& basis, const Pose& pose, std::size_t control_count) {
  const RigFrame rig = pose_rig(basis.skeleton, pose);
  std::vector<float> raw = rig.joint_features;
  const std::vector<float> strains = strains_of(basis, basis.strain, rig);
  raw.insert(raw.end(), strains.begin(), strains.end());
  raw.insert(raw.end(), pose.controls.begin(), pose.controls.end());
  raw.resize(rig.joint_features.size() + strains.size() + control_count, 0.0f);
  return raw;
}

FeatureRange range_of(const Eigen::VectorXd& values, double rest) {
  const double low = std::min(rest, values.minCoeff()), high = std::max(rest, values.maxCoeff());
  const double margin = 0.01 * (high - low), mean = values.mean();
  const double deviation = std::sqrt((values.array() - mean).square().mean());
  FeatureRange range;
  range.low = static_cast<float>(low - margin);
  range.high = static_cast<float>(high + margin);
  range.mean = static_cast<float>(mean);
  range.inverse_scale = static_cast<float>(1 / std::max(deviation, kLeastDeviation));
  return range;
}

using Polyline = std::vector<Eigen::Vector3d>;

constexpr double kSpacing = 0.012;                         // metres between points of a fibre, at most
constexpr double kSpread = 50.0 * std::numbers::pi / 180;  // the outer fibres' angle around the belly
constexpr double kShortest = 0.005;                        // metres; a shorter fibre measures nothing

Polyline path_of(const Muscle& muscle) {
  Polyline path;
  for (const MusclePoint& point : muscle.path) {
    path.emplace_back(point.position[0], point.position[1], point.position[2]);
  }
  return path;
}

double length_of(const Polyline& line) {
  double length = 0;
  for (std::size_t k = 1; k < line.size(); ++k) length += (line[k] - line[k - 1]).norm();
  return length;
}

// `count` points at equal distances along the line, its ends included.
Polyline resample(const Polyline& line, std::size_t count) {
  Polyline result;
  const double step = length_of(line) / static_cast<double>(count - 1);
  double passed = 0;
  std::size_t segment = 1;
  for (std::size_t k = 0; k < count; ++k) {
    const double at = step * static_cast<double>(k);
    while (segment + 1 < line.size() && passed + (line[segment] - line[segment - 1]).norm() < at) {
      passed += (line[segment] - line[segment - 1]).norm();
      ++segment;
    }
    const Eigen::Vector3d along = line[segment] - line[segment - 1];
    const double t = along.norm() > 0 ? std::clamp((at - passed) / along.norm(), 0.0, 1.0) : 0;
    result.push_back(line[segment - 1] + t * along);
  }
  return result;
}

void smooth(Polyline& line) {
  const Polyline old = line;
  for (std::size_t k = 1; k + 1 < line.size(); ++k) line[k] = 0.25 * (old[k - 1] + old[k + 1]) + 0.5 * old[k];
}

// A muscle's middle line, the direction along it and the direction from it to the skin, at equal distances.
struct Belly {
  Polyline line, along, outward;
};

Belly make_belly(const Muscle& muscle, const NearestSkin& nearest) {
  const Polyline path = path_of(muscle);
  const double length = length_of(path);
  Belly belly;
  if (path.size() < 2 || !(length > kShortest)) return belly;
  const auto count = static_cast<std::size_t>(std::clamp(std::ceil(length / kSpacing), 4.0, 200.0)) + 1;
  belly.line = resample(path, count);
  smooth(belly.line);
  // One direction for the whole muscle, so that a fibre does not jump from one side of a limb to the other.
  Eigen::Vector3d side = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : belly.line) side += nearest(point).position - point;
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::Vector3d along = (belly.line[std::min(k + 1, count - 1)] - belly.line[k > 0 ? k - 1 : 0]).normalized();
    Eigen::Vector3d out = side - side.dot(along) * along;
    if (!(out.norm() > 1e-6)) out = along.unitOrthogonal();
    belly.along.push_back(along);
    belly.outward.push_back(out.normalized());
  }
  return belly;
}

// One fibre on the skin. `angle` turns around the belly, zero facing the skin.
std::vector<SkinPoint> project_fibre(const Belly& belly, double radius, double angle, const NearestSkin& nearest) {
  Polyline line;
  for (std::size_t k = 0; k < belly.line.size(); ++k) {
    const Eigen::Vector3d out = Eigen::AngleAxisd(angle, belly.along[k]) * belly.outward[k];
    line.push_back(nearest(belly.line[k] + radius * out).position);
  }
  smooth(line);
  smooth(line);
  std::vector<SkinPoint> fibre;
  for (const Eigen::Vector3d& point : line) {
    const SkinPoint on_skin = nearest(point);
    const bool apart = fibre.empty() || (on_skin.position - fibre.back().position).norm() > 0.25 * kSpacing;
    if (apart) fibre.push_back(on_skin);
  }
  return fibre;
}

double length_of(const std::vector<SkinPoint>& fibre) {
  double length = 0;
  for (std::size_t k = 1; k < fibre.size(); ++k) length += (fibre[k].position - fibre[k - 1].position).norm();
  return length;
}

class TableBuilder {
 public:
  TableBuilder() { table_.fibre_begin.push_back(0); }

  void add(const std::string& name, const std::vector<SkinPoint>& fibre) {
    for (const SkinPoint& point : fibre) {
      FibrePoint entry;
      entry.a = index_of(point.vertices[0]);
      entry.b = index_of(point.vertices[1]);
      entry.c = index_of(point.vertices[2]);
      entry.wa = static_cast<float>(point.weights[0]);
      entry.wb = static_cast<float>(point.weights[1]);
      entry.wc = static_cast<float>(point.weights[2]);
      table_.points.push_back(entry);
    }
    table_.fibre_begin.push_back(static_cast<std::uint32_t>(table_.points.size()));
    table_.rest_length.push_back(1.0f);
    table_.names.push_back(name);
  }

  StrainTable take() { return std::move(table_); }

 private:
  std::uint32_t index_of(std::uint32_t vertex) {
    const auto [place, added] = index_.emplace(vertex, static_cast<std::uint32_t>(table_.vertices.size()));
    if (added) table_.vertices.push_back(vertex);
    return place->second;
  }

  StrainTable table_;
  std::map<std::uint32_t, std::uint32_t> index_;
};

}  // namespace

FadeTable joint_manifold(const Skeleton& skeleton, const RawFeatures& raw, const std::vector<int>& folds) {
  const std::vector<std::vector<std::uint32_t>> near = neighbourhoods(skeleton);
  std::vector<MatrixXd> directions(near.size());
  FadeTable table;
  table.tolerance.resize(near.size());
  parallel_for(near.size(), [&](std::size_t j) {
    const JointFrames frames{raw(Eigen::all, columns_of(near[j])).cast<double>(),
                             raw.middleCols(9 * static_cast<Index>(j), 9).cast<double>()};
    directions[j] = axes_not_shown(frames.near);
    table.tolerance[j] = static_cast<float>(tolerance_of(frames, folds));
  });
  table.joint_begin = table.direction_begin = {0};
  for (std::size_t j = 0; j < near.size(); ++j) {
    table.joints.insert(table.joints.end(), near[j].begin(), near[j].end());
    for (Index row = 0; row < directions[j].rows(); ++row) {
      for (Index k = 0; k < directions[j].cols(); ++k) {
        table.directions.push_back(static_cast<float>(directions[j](row, k)));
      }
    }
    table.joint_begin.push_back(static_cast<std::uint32_t>(table.joints.size()));
    table.direction_begin.push_back(table.direction_begin.back() + static_cast<std::uint32_t>(directions[j].rows()));
  }
  return table;
}

std::vector<double> joint_turns(const RawFeatures& raw, std::size_t joint_count) {
  std::vector<double> turns;
  for (std::size_t j = 0; j < joint_count; ++j) {
    const auto own = raw.middleCols(9 * static_cast<Index>(j), 9).cast<double>();
    turns.push_back(own.squaredNorm() / static_cast<double>(std::max<Index>(1, raw.rows())));
  }
  return turns;
}

std::vector<std::uint32_t> varying_features(const Eigen::MatrixXd& features, std::uint32_t begin, std::uint32_t count) {
  constexpr double kLeastVariance = 0.01;  // less is noise
  std::vector<std::uint32_t> indices;
  for (std::uint32_t k = begin; k < begin + count; ++k) {
    const double variance = features.col(k).squaredNorm() / static_cast<double>(features.rows());
    if (variance > kLeastVariance) indices.push_back(k);
  }
  return indices;
}

std::vector<float> measure_strains(const Basis& basis, const Pose& pose) {
  return measure_strains(basis, basis.strain, pose);
}

std::vector<float> measure_strains(const Basis& basis, const StrainTable& fibres, const Pose& pose) {
  return strains_of(basis, fibres, pose_rig(basis.skeleton, pose));
}

FeatureSamples measure_features(const Basis& basis, std::span<const Pose* const> poses, const KnownFeatures& known) {
  const std::size_t controls = poses.empty() ? 0 : poses[0]->controls.size();
  for (const Pose* pose : poses) {
    if (pose->controls.size() == controls) continue;
    throw Error(ErrorKind::mismatch, "some training frames have " + std::to_string(controls) + " controls, others " +
                                         std::to_string(pose->controls.size()));
  }
  const std::vector<float> rest = raw_features(basis, bind_pose(basis.skeleton), controls);
  const auto count = static_cast<Eigen::Index>(rest.size()), frames = static_cast<Eigen::Index>(poses.size());
  RawFeatures raw(frames + 1, count);
  raw.row(0) = Eigen::Map<const Eigen::RowVectorXf>(rest.data(), count);
  parallel_for(poses.size(), [&](std::size_t n) {
    const auto row = static_cast<Eigen::Index>(n) + 1;
    if (n < known.rows.size() && known.rows[n] >= 0) {
      raw.row(row) = known.raw.row(known.rows[n]);
    } else {
      const std::vector<float> measured = raw_features(basis, *poses[n], controls);
      raw.row(row) = Eigen::Map<const Eigen::RowVectorXf>(measured.data(), count);
    }
  });

  FeatureSamples samples;
  samples.control_count = static_cast<std::uint32_t>(controls);
  samples.raw = raw.bottomRows(frames);
  for (Eigen::Index k = 0; k < count; ++k) {
    samples.ranges.push_back(range_of(samples.raw.col(k).cast<double>(), double{raw(0, k)}));
  }
  // The standardising kernel itself: all features are one row of numbers to it.
  RawFeatures standardised(frames + 1, count);
  std::vector<float> excess(static_cast<std::size_t>(raw.size()));
  cpu::residual_features(samples.ranges, {raw.data(), excess.size()}, {}, {}, static_cast<std::uint32_t>(frames + 1),
                         {standardised.data(), excess.size()}, excess);
  samples.rest = standardised.row(0).cast<double>();
  samples.values = standardised.bottomRows(frames).cast<double>();
  return samples;
}

std::vector<JointFeatures> learned_features(const Character& character, std::span<const Pose* const> poses) {
  const std::vector<JointFeatures> usual = joint_features_of(character.skeleton);
  std::vector<JointFeatures> features = attached_features(character, usual);
  const std::vector<JointFeatures> sliding = sliding_features(character, features, poses);
  const bool enough = poses.size() > 9 * (features.size() + sliding.size());
  if (enough) features.insert(features.end(), sliding.begin(), sliding.end());
  return features == usual ? std::vector<JointFeatures>{} : features;
}

StrainTable make_strain_table(const Basis& basis, const std::vector<Muscle>& muscles) {
  TableBuilder builder;
  const Positions rest = rows_of(basis.mesh.rest);
  const Triangles triangles = rows_of(basis.mesh.triangles);
  if (triangles.rows() == 0) return builder.take();
  const NearestSkin nearest(rest, triangles);
  for (const Muscle& muscle : muscles) {
    const Belly belly = make_belly(muscle, nearest);
    for (int k = 0; k < muscle.fibre_count && !belly.line.empty(); ++k) {
      const double place = muscle.fibre_count > 1 ? 2.0 * k / (muscle.fibre_count - 1) - 1 : 0;  // -1 .. 1
      const std::vector<SkinPoint> fibre = project_fibre(belly, muscle.radius, place * kSpread, nearest);
      if (length_of(fibre) > kShortest) builder.add(muscle.name + "/" + std::to_string(k + 1), fibre);
    }
  }
  StrainTable table = builder.take();
  // The strain is the length less one where the rest length is 1 m.
  for (std::size_t k = 0; const float strain : measure_strains(basis, table, bind_pose(basis.skeleton))) {
    table.rest_length[k++] = 1 + strain;
  }
  return table;
}

StrainTable keep_fibres(const StrainTable& strain, const std::vector<std::uint32_t>& kept) {
  StrainTable result;
  result.fibre_begin = {0};
  std::map<std::uint32_t, std::uint32_t> place;  // of a strain vertex in the result
  const auto moved = [&](std::uint32_t vertex) {
    const auto [entry, added] = place.emplace(vertex, static_cast<std::uint32_t>(result.vertices.size()));
    if (added) result.vertices.push_back(strain.vertices[vertex]);
    return entry->second;
  };
  for (const std::uint32_t fibre : kept) {
    for (std::uint32_t p = strain.fibre_begin[fibre]; p < strain.fibre_begin[fibre + 1]; ++p) {
      FibrePoint point = strain.points[p];
      point.a = moved(point.a);
      point.b = moved(point.b);
      point.c = moved(point.c);
      result.points.push_back(point);
    }
    result.fibre_begin.push_back(static_cast<std::uint32_t>(result.points.size()));
    result.rest_length.push_back(strain.rest_length[fibre]);
    result.names.push_back(strain.names[fibre]);
  }
  return result;
}

std::vector<std::size_t> fibre_muscles(const StrainTable& strain, const std::vector<Muscle>& muscles) {
  std::map<std::string, std::size_t> index;
  for (std::size_t m = 0; m < muscles.size(); ++m) index[muscles[m].name] = m;
  return transformed(strain.names, [&](const std::string& name) { return index.at(name.substr(0, name.rfind('/'))); });
}

}  // namespace bodyopt::trainer
