#include "trainer/train/fit/train.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/parallel.h"
#include "runtime/core/error.h"
#include "runtime/host/rig.h"
#include "trainer/train/coverage/coverage.h"
#include "trainer/train/data/data_warnings.h"
#include "trainer/train/data/learned_poses.h"
#include "trainer/train/features/features.h"
#include "trainer/train/fit/fade.h"
#include "trainer/train/fit/groundwork.h"
#include "trainer/train/fit/staged_fit.h"
#include "trainer/train/pack/residual.h"
#include "trainer/train/regions/regions.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::trainer {
namespace {

// Folds of whole takes, ten at most, with their mirror images.
std::vector<int> take_folds(const SampleSet& set) {
  constexpr int kMostFolds = 10;
  std::vector<int> folds;
  for (const Sample& sample : set.train) {
    folds.push_back((sample.image_of < 0 ? sample.take : sample.image_of) % kMostFolds);
  }
  return folds;
}

ErrorModel error_model(const RegionModel& region, const SelectedRegion& selected, const FeatureSamples& features,
                       const std::vector<int>& folds) {
  const Regression& fit = region.fits[selected.fit];
  const RegressionData data = regression_data(features, region, folds);
  const Eigen::VectorXd& energy = region.components.energy;
  return calibrate({data, fit, frame_energies(region, selected, fit)}, {energy.begin(), energy.end()});
}

std::vector<LeftOutFrame> without_takes(const RegionModel& region, const SelectedRegion& selected,
                                        const FeatureSamples& features, const std::vector<int>& takes,
                                        const ErrorModel& model) {
  const Regression& fit = region.fits[selected.fit];
  const RegressionData data = regression_data(features, region, takes);
  const Regression refit = refit_regression(data, static_cast<int>(fit.centres.rows()), fit);
  return left_out_frames({data, refit, frame_energies(region, selected, refit)}, model);
}

// Returns the coverage table of the regions that are kept. `packed`: those of the model.
CoverageTable region_coverage(const Character& character, const ResidualModel& model,
                              const std::vector<std::size_t>& packed, const FeatureSamples& features,
                              const Selection& selection, const std::vector<int>& takes) {
  std::vector<ErrorModel> errors(packed.size());
  std::vector<std::vector<LeftOutFrame>> left_out(packed.size());
  parallel_for(packed.size(), [&](std::size_t k) {
    const RegionModel& region = model.regions[packed[k]];
    errors[k] = error_model(region, selection[packed[k]], features, model.folds);
    left_out[k] = without_takes(region, selection[packed[k]], features, takes, errors[k]);
  });
  grow_by_takes(left_out, errors);
  CoverageTable coverage;
  coverage.joint_begin = {0};
  for (std::size_t k = 0; k < packed.size(); ++k) {
    const RegionWeights& region = model.regions[packed[k]].region;
    const double size = std::accumulate(region.weights.begin(), region.weights.end(), 0.0);
    std::vector<std::uint32_t> joints;
    for (const std::string& name : joints_of(character, region)) {
      joints.push_back(static_cast<std::uint32_t>(character.skeleton.find(name)));
    }
    append_region(region.name, joints, size, errors[k], coverage);
  }
  return coverage;
}

// How much each region moves and what cross-validation left of it.
std::vector<RegionFit> region_fits(const Character& character, const ResidualModel& model) {
  std::vector<RegionFit> fits;
  for (const RegionModel& region : model.regions) {
    const double size = std::accumulate(region.region.weights.begin(), region.region.weights.end(), 0.0);
    const double motion2 = region.components.energy.mean() / size;
    const double left2 = std::pow(region.fits.front().validation_error, 2) / size;
    fits.push_back({region.region.name, joints_of(character, region.region).front(), region.region.vertices.size(),
                    1e3 * std::sqrt(motion2), 1e3 * std::sqrt(left2)});
  }
  return fits;
}

// `fibres`: all of them, as the model's features are numbered; `first`: the feature of the first.
std::vector<MuscleShare> muscle_shares(const StrainTable& fibres, const std::vector<Muscle>& muscles,
                                       const ResidualModel& model, std::uint32_t first) {
  std::map<std::string, double> explained;
  for (const Muscle& muscle : muscles) explained[muscle.name] = 0;
  const std::vector<std::size_t> muscle_of_fibre = fibre_muscles(fibres, muscles);
  double energy = 0;
  for (const RegionModel& region : model.regions) {
    energy += region.components.energy.sum();
    for (std::size_t k = 0; k < region.explained.size(); ++k) {
      const std::uint32_t feature = region.features[k];
      if (feature < first || feature >= first + fibres.fibre_count()) continue;
      explained[muscles[muscle_of_fibre[feature - first]].name] += region.explained[k];
    }
  }
  std::vector<MuscleShare> shares;
  for (const auto& [name, value] : explained) shares.push_back({name, energy > 0 ? value * (100 / energy) : 0});
  return shares;
}

// The result as the basis tells it.
Json report_of(const TrainingResult& result, const SampleSet& set) {
  Json regions = Json::array(), muscles = Json::object();
  for (const RegionFit& fit : result.fits) {
    regions.push_back({{"name", fit.name},
                       {"joint", fit.joint},
                       {"vertices", fit.vertices},
                       {"motion_rms_mm", fit.motion_rms_mm},
                       {"validation_rms_mm", fit.validation_rms_mm}});
  }
  for (const MuscleShare& muscle : result.muscles) muscles[muscle.name] = muscle.percent;
  return {{"train_frames", set.train.size()},
          {"heldout_frames", set.heldout.size()},
          {"unconverged_frames", set.unconverged},
          {"fibres", result.basis.strain.fibre_count()},
          {"coefficients", result.basis.residual.coefficient_count()},
          {"centres", result.basis.residual.centre_count()},
          {"expected_rms_mm", result.expected_mm},
          {"regions", regions},
          {"muscles_explain_percent", muscles},
          {"warnings", result.warnings}};
}

std::vector<std::string> warnings_of(const SampleSet& set, const Groundwork& ground, const ResidualModel& model) {
  const Eigen::MatrixXd& values = ground.features.values;
  const auto varying = varying_features(values, 0, static_cast<std::uint32_t>(values.cols()));
  std::vector<Contradiction> contradictions;
  std::map<std::pair<std::size_t, std::uint32_t>, OutlierVertex> outliers;  // by frame and vertex, each once
  for (const RegionModel& region : model.regions) {
    contradictions.insert(contradictions.end(), region.contradictions.begin(), region.contradictions.end());
    for (const OutlierVertex& outlier : region.outliers)
      outliers.emplace(std::pair(outlier.frame, outlier.vertex), outlier);
  }
  std::vector<OutlierVertex> all_outliers;
  for (const auto& [place, outlier] : outliers) all_outliers.push_back(outlier);
  std::vector<std::string> warnings;
  for (const std::vector<std::string>& some :
       {contradiction_warnings(set, contradictions), outlier_warnings(set, ground.order, all_outliers),
        constant_control_warnings(set), few_frames_warnings(set, varying.size())}) {
    warnings.insert(warnings.end(), some.begin(), some.end());
  }
  return warnings;
}

// Packs what is worth its bytes, and all that the basis says of itself.
TrainingResult packed_result(const SampleSet& set, const TrainOptions& options, Groundwork& ground,
                             const ResidualModel& model) {
  TrainingResult result;
  const Basis& bare = ground.base.basis;
  const TradeOff trade_off(bare, model);
  const Selection selection = trade_off.choose(options);
  result.basis = bare;
  const PackedResidual packed = pack_into(result.basis, model, selection);
  result.curve = trade_off.curve();
  result.fits = region_fits(ground.ordered, model);
  result.muscles = muscle_shares(bare.strain, ground.muscles, model, joint_feature_count(bare.skeleton));
  result.expected_mm = 1e3 * expected_error(model, selection);
  result.smoothing_radius = ground.base.radius;
  result.warnings = warnings_of(set, ground, model);
  result.basis.coverage =
      region_coverage(ground.ordered, model, packed.regions, ground.features, selection, take_folds(set));
  result.basis.metadata["curve"] = curve_text(result.curve);
  result.basis.metadata["report"] = report_of(result, set).dump();
  result.basis.metadata[kLearnedPoses] = learned_poses_text(set);
  return result;
}

// Calls `use` with the fit and its groundwork.
template <typename Use>
auto prepared(const SampleSet& set, TrainOptions options, std::vector<std::string>& notes, const Use& use) {
  check_samples(set);
  for (;; options.update = false) {
    StagedFit fit(set, options, notes);
    Groundwork ground(set, fit.options(), fit.curves(), fit.earlier_features());
    if (fit.suits(ground)) return use(fit, ground);
  }
}

}  // namespace

std::vector<RegionWeights> training_regions(const SampleSet& set, const TrainOptions& options) {
  std::vector<std::string> unheard;
  return prepared(set, options, unheard, [](StagedFit& fit, const Groundwork& ground) {
    return renumbered(fit.layout(ground).regions, ground.order);
  });
}

TrainingResult train(const SampleSet& set, const TrainOptions& options) {
  std::vector<std::string> notes;
  TrainingResult result = prepared(set, options, notes, [&](StagedFit& fit, Groundwork& ground) {
    const Layout layout = fit.layout(ground);
    if (fit.is_update(ground)) {
      ground.base.basis.metadata["provenance"] =
          provenance_text(set.character, ground.base.radius, fit.options(), true);
    }
    ResidualModel model{set.controls, ground.features.ranges, fit.regions(ground, layout), ground.shapes.vertex_count(),
                        training_folds(set)};
    model.fade = fade_table(ground, model.regions, model.folds, training_origins(set));
    TrainingResult found = packed_result(set, options, ground, model);
    found.regions = renumbered(layout.regions, ground.order);
    return found;
  });
  result.notes = std::move(notes);
  return result;
}

}  // namespace bodyopt::trainer
