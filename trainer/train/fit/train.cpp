#include "trainer/train/fit/train.h"

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
#include "trainer/train/coverage/coverage.h"
#include "trainer/train/data/data_warnings.h"
#include "trainer/train/features/features.h"
#include "trainer/train/features/strain.h"
#include "trainer/train/fit/fade.h"
#include "trainer/train/fit/groundwork.h"
#include "trainer/train/fit/staged_fit.h"
#include "trainer/train/pack/residual.h"
#include "trainer/train/pack/selection_error.h"
#include "trainer/train/pack/trade_off.h"
#include "trainer/train/regions/regions.h"
#include "trainer/train/skinning/mesh_table.h"

namespace bodyopt {
namespace {

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

}  // namespace bodyopt
