#include "trainer/train/residual.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "trainer/train/components.h"
#include "trainer/train/features.h"
#include "trainer/train/fit.h"
#include "trainer/train/mesh_table.h"
#include "trainer/train/parallel.h"
#include "trainer/train/region_features.h"
#include "trainer/train/residual_table.h"
#include "trainer/train/unpose.h"

namespace bodyopt {
namespace {

constexpr double kLeastComponent = 2e-5;  // metres RMS over a region's vertices
constexpr double kLeastEntry = 2e-5;      // metres, in the frame where it moves its vertex most

// What every region learns from.
struct TrainingData {
  const Character& character;
  FrameRows deltas;          // frames x 3V, un-posed, metres
  Eigen::MatrixXd features;  // frames x F, standardised
  Eigen::RowVectorXd rest;   // F
  std::vector<int> folds;
};

FrameRows unpose_samples(const Basis& basis, const std::vector<std::uint32_t>& order,
                         const std::vector<Sample>& samples) {
  FrameRows deltas(static_cast<Eigen::Index>(samples.size()), static_cast<Eigen::Index>(basis.mesh.rest.size()));
  parallel_for("un-pose", samples.size(), [&](std::size_t f) {
    const Positions delta = unpose_ddm(basis, samples[f].pose, in_order(samples[f].shape, order));
    deltas.row(static_cast<Eigen::Index>(f)) =
        Eigen::Map<const Eigen::RowVectorXd>(delta.data(), delta.size()).cast<float>();
  });
  return deltas;
}

// Sets the ranges and controls of basis.residual. The rest pose belongs to the trained range.
TrainingData gather(Basis& basis, const Character& character, const std::vector<std::uint32_t>& order,
                    const std::vector<Sample>& samples) {
  std::vector<Pose> poses = {bind_pose(basis.skeleton)};
  std::size_t controls = 0;
  for (const Sample& sample : samples) {
    poses.push_back(sample.pose);
    controls = std::max(controls, sample.pose.controls.size());
  }
  basis.residual = {};
  for (std::size_t k = 0; k < controls; ++k) basis.residual.controls.push_back("control" + std::to_string(k + 1));
  const FrameRows raw = raw_features(basis, poses);
  basis.residual.features = feature_ranges(raw);
  const Eigen::MatrixXd standardised = standardised_features(basis, raw).cast<double>();
  return {character, unpose_samples(basis, order, samples), standardised.bottomRows(raw.rows() - 1),
          standardised.row(0), time_folds(samples.size())};
}

// Displacements times the region's weights: summed over the regions they are the displacements again. frames x 3n
FrameRows region_targets(const SoftRegion& region, const FrameRows& deltas) {
  const auto count = static_cast<Eigen::Index>(region.vertices.size());
  FrameRows targets(deltas.rows(), 3 * count);
  for (Eigen::Index n = 0; n < count; ++n) {
    const auto k = static_cast<std::size_t>(n);
    targets.middleCols<3>(3 * n) = region.weights[k] * deltas.middleCols<3>(3 * Eigen::Index{region.vertices[k]});
  }
  return targets;
}

// So that no direction exceeds 1 and halves keep their digits; the coefficients are then in metres.
void scale_directions(RegionModel& model, const Eigen::MatrixXd& coefficients) {
  model.largest.resize(coefficients.cols());
  for (Eigen::Index k = 0; k < coefficients.cols(); ++k) {
    const double scale = std::max(double{model.directions.col(k).cwiseAbs().maxCoeff()}, 1e-12);
    model.directions.col(k) /= static_cast<float>(scale);
    model.weights.row(k) *= scale;
    model.largest[k] = scale * coefficients.col(k).cwiseAbs().maxCoeff();
  }
}

struct RegionLimits {
  int components;
  int centres;
  double least_component;  // metres RMS over the region's vertices
  bool joints_only;
};

RegionModel train_region(const SoftRegion& region, const TrainingData& data, const Basis& basis,
                         const RegionLimits& limits, std::uint64_t seed) {
  const float extent = std::accumulate(region.weights.begin(), region.weights.end(), 0.0f);
  const Components components = principal_components(region_targets(region, data.deltas), limits.components,
                                                     limits.least_component * std::sqrt(double{extent}), seed);
  RegionModel model;
  model.vertices = region.vertices;
  model.directions = components.directions;
  model.features = limits.joints_only ? joint_features_only(basis)
                                      : add_explaining_strains(nearby_features(region, data.character, basis), basis,
                                                               data.features, components.coefficients);
  FitProblem problem;
  problem.features = data.features(Eigen::all, model.features);
  problem.rest = data.rest(model.features);
  problem.coefficients = components.coefficients;
  problem.folds = data.folds;
  problem.most_centres = limits.centres;
  const FitResult fit = fit_coefficients(problem);
  model.centres = fit.centres;
  model.inverse_width2 = fit.inverse_width2;
  model.weights = fit.weights;
  scale_directions(model, components.coefficients);
  return model;
}

std::vector<RegionModel> train_regions(const std::vector<SoftRegion>& regions, const TrainingData& data,
                                       const Basis& basis, const RegionLimits& limits, std::uint64_t seed) {
  std::vector<RegionModel> models(regions.size());
  parallel_for("regions", regions.size(),
               [&](std::size_t r) { models[r] = train_region(regions[r], data, basis, limits, seed + r); });
  return models;
}

// The linear method of the table of methods, given the bytes of the full one.
void train_joint_linear(Basis& basis, const std::vector<SoftRegion>& regions, const TrainingData& data,
                        const TrainOptions& options) {
  RegionLimits limits{options.components, 0, 0, true};
  for (bool enough = false; !enough;) {
    const std::vector<RegionModel> models = train_regions(regions, data, basis, limits, options.seed);
    bool exhausted = true;
    for (const RegionModel& model : models) exhausted = exhausted && model.weights.rows() < limits.components;
    for (int k = std::min(options.components, limits.components); k <= limits.components && !enough; ++k) {
      pack_residual(models, basis.mesh.vertex_count(), k, 0, basis.residual);
      enough = table_bytes(basis)["residual"] >= options.match_bytes;
    }
    enough = enough || exhausted;
    limits.components *= 2;
  }
}

}  // namespace

void train_residual(Basis& basis, const Character& character, const std::vector<std::uint32_t>& order,
                    const std::vector<Sample>& samples, const TrainOptions& options) {
  const TrainingData data = gather(basis, character, order, samples);
  const std::vector<SoftRegion> regions = soft_regions(character);
  if (options.joint_only_linear) return train_joint_linear(basis, regions, data, options);
  const RegionLimits limits{options.components, options.centres, kLeastComponent, false};
  pack_residual(train_regions(regions, data, basis, limits, options.seed), basis.mesh.vertex_count(),
                options.components, kLeastEntry, basis.residual);
}

}  // namespace bodyopt
