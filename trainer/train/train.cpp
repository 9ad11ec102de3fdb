#include "trainer/train/train.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "runtime/basis/error.h"
#include "runtime/basis/hexadecimal.h"
#include "runtime/rig.h"
#include "trainer/parallel.h"
#include "trainer/single_threaded_products.h"
#include "trainer/train/coverage.h"
#include "trainer/train/data_warnings.h"
#include "trainer/train/ddm.h"
#include "trainer/train/features.h"
#include "trainer/train/mesh_table.h"
#include "trainer/train/regions.h"
#include "trainer/train/residual.h"
#include "trainer/train/selection_error.h"
#include "trainer/train/strain.h"
#include "trainer/train/trade_off.h"
#include "trainer/train/unpose.h"
#include "trainer/train/unposed_shapes.h"

namespace bodyopt {
namespace {

// Fewer frames cannot be split for cross-validation.
constexpr std::size_t kFewestFrames = 12;
// Direct Delta Mush and nothing else, and the moments it is made of. `ordered`: the character in runtime order.
struct Base {
  Basis basis;
  std::vector<VertexMoments> moments;
};

Base make_base(const Character& ordered, double radius, const TrainOptions& options) {
  Base base;
  base.moments = ddm_moments(ordered.vertices, ordered.triangles, ordered.weights,
                             {.radius = radius, .steps = options.smoothing_steps});
  Basis& basis = base.basis;
  basis.skeleton = ordered.skeleton;
  basis.mesh = make_mesh_table(ordered);
  basis.ddm = pack_ddm(base.moments);
  basis.strain.fibre_begin = {0};
  basis.residual.blend_begin.assign(basis.mesh.block_count() + 1, 0);
  basis.metadata["units"] = "metres";
  basis.metadata["topology_hash"] = hexadecimal(topology_hash(basis.mesh));
  basis.metadata["skeleton_hash"] = hexadecimal(skeleton_hash(basis.skeleton));
  const nlohmann::json provenance = {{"program", "bodyopt " BODYOPT_VERSION},
                                     {"character", ordered.name},
                                     {"smoothing_radius_m", radius},
                                     {"smoothing_steps", options.smoothing_steps},
                                     {"components", options.components},
                                     {"centres", options.centres},
                                     {"budget", options.budget},
                                     {"tolerance_mm", options.tolerance_mm},
                                     {"seed", options.seed}};
  basis.metadata["provenance"] = provenance.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return base;
}

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

// Sum of the squared un-posed displacements of some training frames, spread evenly.
double left_to_learn(const SampleSet& set, const Character& ordered, const Basis& basis,
                     const std::vector<std::uint32_t>& order) {
  const std::vector<std::size_t> probes = spread_evenly(set.train.size(), 24);
  std::vector<std::uint32_t> all(order.size());
  std::iota(all.begin(), all.end(), 0u);
  return UnposedShapes(set, ordered, basis, order, Method::Unposing::ddm)("train: smoothing radius", probes, all)
      .cast<double>()
      .squaredNorm();
}

// The radius given; or the default or twice that, whichever leaves less to learn: a part of a body needs more than its
// own size tells.
Base choose_base(const SampleSet& set, const Character& ordered, const std::vector<std::uint32_t>& order,
                 const TrainOptions& options) {
  const auto fits = [&](const Base& base) {
    return !(options.budget > 0) || bytes_per_vertex(base.basis) <= options.budget;
  };
  if (options.smoothing_radius > 0) return make_base(ordered, options.smoothing_radius, options);
  const double radius = default_smoothing_radius(ordered.vertices);
  Base base = make_base(ordered, radius, options), wider = make_base(ordered, 2 * radius, options);
  const bool better =
      fits(wider) && left_to_learn(set, ordered, wider.basis, order) < left_to_learn(set, ordered, base.basis, order);
  return better ? std::move(wider) : std::move(base);
}

// Influences are measured on some frames, spread evenly.
std::vector<FeatureGroup> feature_groups(const Base& base, const std::vector<Muscle>& muscles,
                                         const FeatureSamples& features, UnposedShapes& shapes) {
  constexpr std::size_t kMostFrames = 800;
  const std::vector<std::size_t> frames = spread_evenly(static_cast<std::size_t>(features.values.rows()), kMostFrames);
  std::vector<std::uint32_t> all(shapes.vertex_count());
  std::iota(all.begin(), all.end(), 0u);
  return make_feature_groups(base.basis, base.moments, muscles, features.values(frames, Eigen::all),
                             shapes("train: influences", frames, all));
}

// Static regions: groups begin with the joints.
std::vector<RegionWeights> regions_of(const Character& character, const std::vector<FeatureGroup>& groups,
                                      const std::vector<RegionWeights>& painted, Method::Support support) {
  const std::size_t joints = feature_joints(character.skeleton).size();
  switch (support) {
    case Method::Support::dynamic_regions:
      return make_regions(character, groups, painted);
    case Method::Support::static_regions:
      return make_regions(character, {groups.begin(), groups.begin() + static_cast<std::ptrdiff_t>(joints)}, painted);
    case Method::Support::whole_skin:
      break;
  }
  RegionWeights whole{"skin", {}, {}};
  whole.vertices.resize(static_cast<std::size_t>(character.vertices.rows()));
  std::iota(whole.vertices.begin(), whole.vertices.end(), 0u);
  whole.weights.assign(whole.vertices.size(), 1.0);
  return {whole};
}

std::vector<std::uint32_t> inverse_of(const std::vector<std::uint32_t>& order) {
  std::vector<std::uint32_t> inverse(order.size());
  for (std::size_t v = 0; v < order.size(); ++v) inverse[order[v]] = static_cast<std::uint32_t>(v);
  return inverse;
}

Base base_with_fibres(const SampleSet& set, const Character& ordered, const std::vector<std::uint32_t>& order,
                      const TrainOptions& options) {
  Base base = choose_base(set, ordered, order, options);
  const double bytes = bytes_per_vertex(base.basis);
  if (options.budget > 0 && bytes > options.budget) refuse_budget(options.budget, bytes, "Direct Delta Mush alone");
  if (options.method.strains) base.basis.strain = make_strain_table(base.basis, set.muscles);
  return base;
}

FeatureSamples features_of(const SampleSet& set, const Basis& basis) {
  std::vector<const Pose*> poses;
  for (const Sample& sample : set.train) poses.push_back(&sample.pose);
  return measure_features(basis, poses);
}

// What fitting starts from, in runtime order.
struct Groundwork {
  Groundwork(const SampleSet& set, const TrainOptions& options)
      : order(morton_order(set.character.vertices)),
        ordered(in_order(set.character, order)),
        base(base_with_fibres(set, ordered, order, options)),
        shapes(set, ordered, base.basis, order, options.method.unposing),
        features(features_of(set, base.basis)),
        groups(feature_groups(base, options.method.strains ? set.muscles : std::vector<Muscle>{}, features, shapes)),
        regions(regions_of(ordered, groups, renumbered(set.regions, inverse_of(order)), options.method.support)) {}
  Groundwork(const Groundwork&) = delete;  // `shapes` refers to the others
  Groundwork& operator=(const Groundwork&) = delete;

  std::vector<std::uint32_t> order;  // welded vertex of each runtime vertex
  Character ordered;
  Base base;
  UnposedShapes shapes;
  FeatureSamples features;
  std::vector<FeatureGroup> groups;
  std::vector<RegionWeights> regions;
};

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
                                 frame_energies(region, selection[r]))});
  }
  return regions;
}

// How much each region moves and what cross-validation left of it, root mean square over its vertices and frames.
nlohmann::json region_report(const Character& character, const ResidualModel& model, std::size_t frames) {
  nlohmann::json list = nlohmann::json::array();
  for (const RegionModel& region : model.regions) {
    const double size = std::accumulate(region.region.weights.begin(), region.region.weights.end(), 0.0);
    const double motion2 = region.components.energy / (static_cast<double>(frames) * size);
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
    energy += region.components.energy;
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
          {"regions", region_report(character, model, set.train.size())},
          {"muscles_explain_percent", muscle_report(fibres, set.muscles, model, joint_feature_count(basis.skeleton))},
          {"warnings", warnings}};
}

std::vector<std::string> warnings_of(const SampleSet& set, const Groundwork& ground, const ResidualModel& model) {
  std::set<std::uint32_t> varying;
  for (const FeatureGroup& group : ground.groups) varying.insert(group.features.begin(), group.features.end());
  std::vector<Contradiction> contradictions;
  for (const RegionModel& region : model.regions) {
    contradictions.insert(contradictions.end(), region.contradictions.begin(), region.contradictions.end());
  }
  std::vector<std::string> warnings;
  for (const std::vector<std::string>& some :
       {contradiction_warnings(set, contradictions), stray_warnings(set, ground.order, ground.shapes.strays()),
        constant_control_warnings(set), few_frames_warnings(set, varying.size())}) {
    warnings.insert(warnings.end(), some.begin(), some.end());
  }
  return warnings;
}

}  // namespace

Basis build_ddm_basis(const Character& character, const TrainOptions& options) {
  const Character ordered = in_order(character, morton_order(character.vertices));
  const double radius =
      options.smoothing_radius > 0 ? options.smoothing_radius : default_smoothing_radius(ordered.vertices);
  return make_base(ordered, radius, options).basis;
}

std::vector<RegionWeights> training_regions(const SampleSet& set, const TrainOptions& options) {
  check_samples(set);
  const SingleThreadedProducts single_threaded;
  const Groundwork ground(set, options);
  return renumbered(ground.regions, ground.order);
}

Basis train(const SampleSet& set, const TrainOptions& options) {
  check_samples(set);
  const SingleThreadedProducts single_threaded;
  Groundwork ground(set, options);
  const Character& ordered = ground.ordered;
  Basis& basis = ground.base.basis;
  std::vector<int> takes;
  for (const Sample& sample : set.train) takes.push_back(sample.take);
  ResidualModel model =
      fit_residual(ordered, ground.shapes, ground.regions, ground.groups, ground.features, takes, options);
  model.controls = set.controls;
  const Basis bare = basis;
  const TradeOff trade_off(bare, model);
  const Selection selection = trade_off.choose(options);
  const PackedResidual packed = pack_into(basis, model, selection);
  basis.metadata["coverage"] =
      coverage_text(region_coverage(ordered, model, packed.regions, ground.features, selection));
  basis.metadata["curve"] = curve_text(trade_off.curve());
  basis.metadata["report"] = report_of(basis, ordered, set, model, bare.strain, expected_error(model, selection),
                                       warnings_of(set, ground, model))
                                 .dump();
  return std::move(basis);
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
