#include "trainer/train/features/features.h"

#include <algorithm>
#include <cmath>

#include "assets/joints_with_skin.h"
#include "base/parallel.h"
#include "runtime/core/error.h"
#include "runtime/cpu/kernels.h"
#include "runtime/host/rig.h"

namespace bodyopt {
namespace {

// The deviation of a feature (radians, strain) counts as this at least: one that hardly moves in training says nothing,
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

}  // namespace

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

std::vector<JointFeatures> learned_features(const Character& character) {
  const std::vector<bool> of_all_skin = joints_of_all_skin(character);
  const std::vector<JointFeatures> usual = joint_features_of(character.skeleton);
  std::vector<JointFeatures> features = usual;
  for (JointFeatures& of : features) {
    if (of_all_skin[of.joint]) of.above = of.joint;
  }
  return features == usual ? std::vector<JointFeatures>{} : features;
}

}  // namespace bodyopt
