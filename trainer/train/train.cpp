#include "trainer/train/train.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/parallel.h"
#include "base/single_threaded_products.h"
#include "runtime/core/error.h"
#include "runtime/host/rig.h"
#include "trainer/train/coverage.h"
#include "trainer/train/data_warnings.h"
#include "trainer/train/ddm.h"
#include "trainer/train/fade.h"
#include "trainer/train/features.h"
#include "trainer/train/groundwork.h"
#include "trainer/train/mesh_table.h"
#include "trainer/train/regions.h"
#include "trainer/train/residual.h"
#include "trainer/train/selection_error.h"
#include "trainer/train/staged_fit.h"
#include "trainer/train/strain.h"
#include "trainer/train/trade_off.h"
#include "trainer/train/unpose.h"

namespace bodyopt {
namespace {

// Fewer frames cannot be split for cross-validation.
constexpr std::size_t kFewestFrames = 12;

void check_pose(const SampleSet& set, const Sample& sample) {
  const Pose& pose = sample.pose;
  if (pose.controls.size() != set.controls.size()) {
    throw Error(ErrorKind::mismatch, frame_name(set, sample) + " has " + std::to_string(pose.controls.size()) +
                                         " control values for " + std::to_string(set.controls.size()) + " controls");
  }
  for (std::size_t k = 0; k < pose.controls.size(); ++k) {
    if (std::isfinite(pose.controls[k])) continue;
    throw Error(ErrorKind::mismatch,
                frame_name(set, sample) + ": the value of control '" + set.controls[k] + "' is not a finite number");
  }
  for (std::size_t j = 0; j < std::min(pose.joints.size(), set.character.skeleton.size()); ++j) {
    const Affine local = affine_from(pose.joints[j]);
    if (Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(&local.m[0][0]).allFinite()) continue;
    throw Error(ErrorKind::mismatch, frame_name(set, sample) + ": the transform of joint '" +
                                         set.character.skeleton.joints[j].name + "' holds a number that is not finite");
  }
}

// What coverage needs to know of the regions that are kept. `packed`: those of the model.
std::vector<RegionCoverage> region_coverage(const Character& character, const ResidualModel& model,
                                            const std::vector<std::size_t>& packed, const FeatureSamples& features,
                                            const Selection& selection) {
  std::vector<RegionCoverage> regions;
  for (const std::size_t r : packed) {
    const RegionModel& region = model.regions[r];
    const double size = std::accumulate(region.region.weights.begin(), region.region.weights.end(), 0.0);
    regions.push_back({region.region.name, joints_of(character, region.region), size,
                       calibrate(regression_data(features, region, model.folds), region.fits[selection[r].fit],
                                 frame_energies(region, selection[r]),
                                 {region.components.energy.begin(), region.components.energy.end()})});
  }
  return regions;
}

// How much each region moves and what cross-validation left of it, root mean square over its vertices and frames.
nlohmann::json region_report(const Character& character, const ResidualModel& model) {
  nlohmann::json list = nlohmann::json::array();
  for (const RegionModel& region : model.regions) {
    const double size = std::accumulate(region.region.weights.begin(), region.region.weights.end(), 0.0);
    const double motion2 = region.components.energy.mean() / size;
    const double left2 = std::pow(region.fits.front().validation_error, 2) / size;
    list.push_back({{"name", region.region.name},
                    {"joint", joints_of(character, region.region).front()},
                    {"vertices", region.region.vertices.size()},
                    {"motion_rms_mm", 1e3 * std::sqrt(motion2)},
                    {"validation_rms_mm", 1e3 * std::sqrt(left2)}});
  }
  return list;
}

// Per cent of the un-posed motion that the strains of each muscle explain beyond the features chosen before them; 0 for
// muscles to which no region listens.
nlohmann::json muscle_report(const StrainTable& strain, const std::vector<Muscle>& muscles, const ResidualModel& model,
                             std::uint32_t first) {
  std::map<std::string, double> worth;
  for (const Muscle& muscle : muscles) worth[muscle.name] = 0;
  const std::vector<std::size_t> muscle_of_fibre = fibre_muscles(strain, muscles);
  double energy = 0;
  for (const RegionModel& region : model.regions) {
    energy += region.components.energy.sum();
    for (std::size_t k = 0; k < region.worth.size(); ++k) {
      const std::uint32_t feature = region.features[k];
      if (feature < first || feature >= first + strain.fibre_count()) continue;
      worth[muscles[muscle_of_fibre[feature - first]].name] += region.worth[k];
    }
  }
  for (auto& [name, value] : worth) value *= energy > 0 ? 100 / energy : 0;
  return worth;
}

// What training says of itself. `fibres`: all of them, as the model's features are numbered.
nlohmann::json report_of(const Basis& basis, const Character& character, const SampleSet& set,
                         const ResidualModel& model, const StrainTable& fibres, double expected,
                         const std::vector<std::string>& warnings) {
  return {{"train_frames", set.train.size()},
          {"heldout_frames", set.heldout.size()},
          {"unconverged_frames", set.unconverged},
          {"fibres", basis.strain.fibre_count()},
          {"coefficients", basis.residual.coefficient_count()},
          {"centres", basis.residual.centre_count()},
          {"expected_rms_mm", 1e3 * expected},
          {"regions", region_report(character, model)},
          {"muscles_explain_percent", muscle_report(fibres, set.muscles, model, joint_feature_count(basis.skeleton))},
          {"warnings", warnings}};
}

std::vector<std::string> warnings_of(const SampleSet& set, const Groundwork& ground, const ResidualModel& model) {
  const Eigen::MatrixXd& values = ground.features.values;
  const auto varying = varying_features(values, 0, static_cast<std::uint32_t>(values.cols()));
  std::vector<Contradiction> contradictions;
  std::map<std::pair<std::size_t, std::uint32_t>, StrayVertex> strays;  // by frame and vertex, each once
  for (const RegionModel& region : model.regions) {
    contradictions.insert(contradictions.end(), region.contradictions.begin(), region.contradictions.end());
    for (const StrayVertex& stray : region.strays) strays.emplace(std::pair(stray.frame, stray.vertex), stray);
  }
  std::vector<StrayVertex> all_strays;
  for (const auto& [place, stray] : strays) all_strays.push_back(stray);
  std::vector<std::string> warnings;
  for (const std::vector<std::string>& some :
       {contradiction_warnings(set, contradictions), stray_warnings(set, ground.order, all_strays),
        constant_control_warnings(set), few_frames_warnings(set, varying.size())}) {
    warnings.insert(warnings.end(), some.begin(), some.end());
  }
  return warnings;
}

// A training from the start of the same data and options makes another basis.
void say_updated(Basis& basis) {
  nlohmann::json provenance = nlohmann::json::parse(basis.metadata.at("provenance"));
  provenance["updated"] = true;
  basis.metadata["provenance"] = provenance.dump();
}

// What is worth its bytes, and all that the basis says of itself.
Basis packed_basis(const SampleSet& set, const TrainOptions& options, Groundwork& ground, const ResidualModel& model) {
  Basis& basis = ground.base.basis;
  const Basis bare = basis;
  const TradeOff trade_off(bare, model);
  const Selection selection = trade_off.choose(options);
  const PackedResidual packed = pack_into(basis, model, selection);
  basis.metadata["coverage"] =
      coverage_text(region_coverage(ground.ordered, model, packed.regions, ground.features, selection));
  basis.metadata["curve"] = curve_text(trade_off.curve());
  basis.metadata["report"] = report_of(basis, ground.ordered, set, model, bare.strain, expected_error(model, selection),
                                       warnings_of(set, ground, model))
                                 .dump();
  return std::move(basis);
}

// Calls `use` with the fit, its samples and its groundwork.
template <typename Use>
auto prepared(const SampleSet& set, TrainOptions options, std::vector<std::string>& notes, const Use& use) {
  check_samples(set);
  const SingleThreadedProducts single_threaded;
  for (;; options.update = false) {
    StagedFit fit(set, options, notes);
    const SampleSet samples = fit.samples();
    Groundwork ground(samples, fit.options(), fit.earlier_features());
    if (fit.suits(ground)) return use(fit, samples, ground);
  }
}

}  // namespace

void check_samples(const SampleSet& set) {
  if (set.train.size() < kFewestFrames) {
    throw Error(ErrorKind::mismatch, "training needs " + std::to_string(kFewestFrames) +
                                         " frames at least, the dataset leaves " + std::to_string(set.train.size()) +
                                         " (held out: " + std::to_string(set.heldout.size()) +
                                         ", unconverged: " + std::to_string(set.unconverged) + ")");
  }
  for (const std::vector<Sample>* samples : {&set.train, &set.heldout}) {
    for (const Sample& sample : *samples) check_pose(set, sample);
  }
}

Basis build_ddm_basis(const Character& character, const TrainOptions& options) {
  const Character ordered = in_order(character, morton_order(character.vertices));
  const double radius =
      options.smoothing_radius > 0 ? options.smoothing_radius : default_smoothing_radius(ordered.vertices);
  return make_ddm_base(ordered, radius, options).basis;
}

std::vector<RegionWeights> training_regions(const SampleSet& set, const TrainOptions& options) {
  std::vector<std::string> unheard;
  return prepared(set, options, unheard, [](StagedFit& fit, const SampleSet& samples, const Groundwork& ground) {
    return renumbered(fit.layout(samples, ground).regions, ground.order);
  });
}

Basis train(const SampleSet& set, const TrainOptions& options, std::vector<std::string>* notes) {
  std::vector<std::string> unheard;
  return prepared(set, options, notes ? *notes : unheard,
                  [&](StagedFit& fit, const SampleSet& samples, Groundwork& ground) {
                    const Layout layout = fit.layout(samples, ground);
                    if (fit.is_update(ground)) say_updated(ground.base.basis);
                    ResidualModel model{set.controls, ground.features.ranges, fit.regions(ground, layout),
                                        ground.shapes.vertex_count(), training_folds(set)};
                    const std::vector<Muscle>& muscles = options.method.strains ? samples.muscles : set.muscles;
                    model.fade = fade_table(ground, muscles, model.regions, model.folds);
                    return packed_basis(samples, options, ground, model);
                  });
}

std::vector<std::string> training_warnings(const Basis& basis) {
  const auto report = basis.metadata.find("report");
  if (report == basis.metadata.end()) return {};
  return nlohmann::json::parse(report->second).value("warnings", std::vector<std::string>{});
}

UnposingResidual unposing_residual(const SampleSet& set, const Basis& basis) {
  const std::vector<std::uint32_t> order = morton_order(set.character.vertices);
  const Character ordered = in_order(set.character, order);
  const std::vector<std::size_t> frames = spread_evenly(set.train.size(), 200);
  std::vector<double> lbs(frames.size()), ddm(frames.size());
  parallel_for(frames.size(), [&](std::size_t n) {
    const Sample& sample = set.train[frames[n]];
    const Positions shape = in_order(sample.shape.read(), order);
    lbs[n] = unpose_linear(ordered, sample.pose, shape).squaredNorm();
    ddm[n] = unpose_ddm(basis, sample.pose, shape).squaredNorm();
  });
  const auto rms_mm = [&](const std::vector<double>& sums) {
    const double count = static_cast<double>(frames.size()) * static_cast<double>(ordered.vertices.rows());
    return count > 0 ? 1e3 * std::sqrt(std::accumulate(sums.begin(), sums.end(), 0.0) / count) : 0;
  };
  return {rms_mm(lbs), rms_mm(ddm)};
}

}  // namespace bodyopt
