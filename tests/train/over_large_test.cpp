// A basis that holds its training frames: what is lost on the way through components, tables and the deformer.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/parallel.h"
#include "geometry/mesh.h"
#include "runtime/core/half.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "tests/support/capsule_limb.h"
#include "trainer/train/fit/fit_regions.h"
#include "trainer/train/pack/trade_off.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

double mean_nearest(const MatrixXd& points) {
  MatrixXd squared = squared_distances(points, points);
  squared.diagonal().setConstant(std::numeric_limits<double>::infinity());
  return squared.rowwise().minCoeff().cwiseSqrt().mean();
}

// Kernels at every frame, as wide as the nearest frames are apart, through all coefficients.
Regression interpolation(const RegressionData& data) {
  Regression fit;
  fit.centres =
      data.features.unaryExpr([](double x) { return double{float_from_half(half_from_float(static_cast<float>(x)))}; });
  fit.centre_frames.resize(static_cast<std::size_t>(data.features.rows()));
  std::iota(fit.centre_frames.begin(), fit.centre_frames.end(), 0);
  fit.inverse_width2 = 0.5 / std::pow(mean_nearest(data.features), 2);
  const auto kernels = [&](const MatrixXd& points) -> MatrixXd {
    return (-fit.inverse_width2 * squared_distances(points, fit.centres)).array().exp();
  };
  const MatrixXd regressors = kernels(data.features).rowwise() - kernels(data.rest).row(0);
  fit.weights = MatrixXd::Zero(data.features.cols() + fit.centres.rows(), data.targets.cols());
  // The rest pose, and frames that are nearly the same to the region, must not get large weights against each other.
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> solver(regressors.rows(), regressors.cols());
  solver.setThreshold(1e-6);
  fit.weights.bottomRows(fit.centres.rows()) = solver.compute(regressors).solve(data.targets);
  fit.errors = MatrixXd::Zero(data.targets.rows(), data.targets.cols());
  return fit;
}

SelectedRegion everything_of(const RegionModel& model) {
  std::vector<std::uint32_t> blocks;
  for (const std::uint32_t vertex : model.region.vertices) {
    if (blocks.empty() || blocks.back() != vertex / kBlockSize) blocks.push_back(vertex / kBlockSize);
  }
  const auto components = static_cast<std::size_t>(model.components.basis.rows());
  return {0, std::vector(components, blocks), std::vector(components, blocks)};
}

// Regions as train() makes them, with as many components as the frames have, every entry and that of its rounding, and
// narrow kernels at every frame which interpolate the coefficients. Frames of one pose and another shape cannot both be
// held. For some hundreds of frames.
Basis over_large_basis(const SampleSet& set) {
  TrainOptions options;
  options.components = static_cast<int>(set.train.size());
  options.centres = 0;
  Groundwork ground(set, options);
  const Layout layout = make_layout(set, ground, options.method);
  const FitContext context(set, ground, layout, options);
  std::vector<std::size_t> regions(layout.regions.size());
  std::iota(regions.begin(), regions.end(), std::size_t{0});
  ResidualModel model{set.controls, ground.features.ranges, std::vector<RegionModel>(regions.size()),
                      ground.shapes.vertex_count(), context.folds};
  fit_regions(
      context, regions, model.regions, [](std::size_t, const RegionModel&) {}, "nothing of it is kept");
  parallel_for(regions.size(), [&](std::size_t r) {
    RegionModel& region = model.regions[r];
    region.fits = {interpolation(regression_data(ground.features, region, context.folds))};
  });
  Selection selection;
  for (const RegionModel& region : model.regions) selection.push_back(everything_of(region));
  pack_into(ground.base.basis, model, selection);
  return std::move(ground.base.basis);
}

// Of the deformer's skin from the training frames, metres.
double largest_distance(const Basis& basis, const SampleSet& set) {
  Deformer deformer(basis, {.name = "cpu"});
  double largest = 0;
  for (const Sample& sample : set.train) {
    const Evaluation evaluation = deformer.evaluate({&sample.pose, 1});
    const Positions skin = welded_from_output(set.character, evaluation.positions.data());
    const double distance = (skin - sample.shape.read()).rowwise().norm().maxCoeff();
    if (!(distance <= largest)) largest = distance;  // a NaN stays
  }
  return largest;
}

// What is left is rounding: 0.05 mm of 1.8 m.
TEST(OverLargeBasis, HoldsItsTrainingFrames) {
  const SampleSet set = limb_samples(100, 0);
  const double distance = largest_distance(over_large_basis(set), set);
  RecordProperty("mm", std::to_string(1e3 * distance));
  EXPECT_LT(distance, 5e-5 * longest_extent(set.character.vertices) / 1.8);
}

}  // namespace
}  // namespace bodyopt::trainer
