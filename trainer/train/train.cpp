#include "trainer/train/train.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "runtime/basis/error.h"
#include "runtime/basis/hexadecimal.h"
#include "trainer/progress.h"
#include "trainer/single_threaded_products.h"
#include "trainer/train/ddm.h"
#include "trainer/train/features.h"
#include "trainer/train/mesh_table.h"
#include "trainer/train/parallel.h"
#include "trainer/train/regions.h"
#include "trainer/train/residual.h"
#include "trainer/train/strain.h"
#include "trainer/train/unpose.h"

namespace bodyopt {
namespace {

// Fewer frames cannot be split for cross-validation.
constexpr std::size_t kFewestFrames = 12;
// Components per region that `linear` may have to reach the bytes asked for.
constexpr int kMostComponents = 128;
// An entry of the basis that moves no vertex of its block by more than this part of the mean displacement is left out
// (both root mean square over the training frames).
constexpr double kNegligible = 4e-3;

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
                                     {"seed", options.seed}};
  basis.metadata["provenance"] = provenance.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return base;
}

void check_samples(const SampleSet& set) {
  if (set.train.size() < kFewestFrames) {
    throw Error(ErrorKind::mismatch, "training needs " + std::to_string(kFewestFrames) +
                                         " frames at least, the dataset leaves " + std::to_string(set.train.size()) +
                                         " (held out: " + std::to_string(set.heldout.size()) +
                                         ", unconverged: " + std::to_string(set.unconverged) + ")");
  }
  for (const Sample& sample : set.train) {
    if (sample.shape.rows() == set.character.vertices.rows() && sample.shape.allFinite()) continue;
    throw Error(ErrorKind::mismatch, "frame " + std::to_string(sample.frame) + " of take " +
                                         std::to_string(sample.take) +
                                         ": its shape does not fit the character, or is not a finite number");
  }
  for (const std::vector<Sample>* samples : {&set.train, &set.heldout}) {
    for (const Sample& sample : *samples) {
      if (sample.pose.controls.size() == set.controls.size()) continue;
      throw Error(ErrorKind::mismatch, "frame " + std::to_string(sample.frame) + " of take " +
                                           std::to_string(sample.take) + " has " +
                                           std::to_string(sample.pose.controls.size()) + " control values for " +
                                           std::to_string(set.controls.size()) + " controls");
    }
  }
}

// Sum of the squared un-posed displacements of some training frames, spread evenly.
double left_to_learn(const SampleSet& set, const Basis& basis, const std::vector<std::uint32_t>& order) {
  constexpr std::size_t kProbes = 24;
  std::vector<double> sums(std::min(kProbes, set.train.size()));
  parallel_for(sums.size(), [&](std::size_t k) {
    const Sample& sample = set.train[k * set.train.size() / sums.size()];
    sums[k] = unpose_ddm(basis, sample.pose, in_order(sample.shape, order)).squaredNorm();
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

// The radius given; or the default or twice that, whichever leaves less to learn: a part of a body needs more than its
// own size tells.
Base choose_base(const SampleSet& set, const Character& ordered, const std::vector<std::uint32_t>& order,
                 const TrainOptions& options) {
  if (options.smoothing_radius > 0) return make_base(ordered, options.smoothing_radius, options);
  const double radius = default_smoothing_radius(ordered.vertices);
  Base base = make_base(ordered, radius, options), wider = make_base(ordered, 2 * radius, options);
  const bool better = left_to_learn(set, wider.basis, order) < left_to_learn(set, base.basis, order);
  return better ? std::move(wider) : std::move(base);
}

Displacements unpose_all(const SampleSet& set, const Basis& basis, const std::vector<std::uint32_t>& order) {
  Displacements displacements(static_cast<Eigen::Index>(set.train.size()), 3 * basis.mesh.vertex_count());
  Progress progress("train: un-posing", set.train.size());
  parallel_for(set.train.size(), [&](std::size_t n) {
    const Positions delta = unpose_ddm(basis, set.train[n].pose, in_order(set.train[n].shape, order));
    displacements.row(static_cast<Eigen::Index>(n)) =
        Eigen::Map<const Eigen::RowVectorXd>(delta.data(), delta.size()).cast<float>();
    progress.advance();
  });
  return displacements;
}

// The residual of the bytes and coefficients to match: as many components per region as it takes, then smaller entries,
// then all there is.
void pack_to_match(Basis& basis, const ResidualModel& model, int components, double negligible,
                   const TrainOptions& options) {
  const auto matches = [&](int count) {
    basis.residual = pack_residual(model, count, negligible);
    return table_bytes(basis).at("residual") >= options.match_bytes &&
           basis.residual.coefficient_count() >= options.match_coefficients;
  };
  constexpr int kHalvings = 20;
  for (int k = 0; k < kHalvings && !matches(components); ++k) negligible *= 0.5;
  int low = 1, high = components;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (matches(middle)) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  basis.residual = pack_residual(model, low, negligible);
}

// What training says of itself: options and counts, and the root mean square per vertex that cross-validation left.
void add_report(Basis& basis, const SampleSet& set, const TrainOptions& options, const ResidualModel& model) {
  double error2 = 0;
  for (const RegionModel& region : model.regions) error2 += std::pow(region.regression.validation_error, 2);
  const nlohmann::json report = {{"train_frames", set.train.size()},
                                 {"heldout_frames", set.heldout.size()},
                                 {"unconverged_frames", set.unconverged},
                                 {"fibres", basis.strain.fibre_count()},
                                 {"regions", basis.residual.regions.size()},
                                 {"coefficients", basis.residual.coefficient_count()},
                                 {"centres", basis.residual.centre_count()},
                                 {"joint_only_linear", options.joint_only_linear},
                                 {"validation_rms_mm", 1e3 * std::sqrt(error2 / basis.mesh.vertex_count())}};
  basis.metadata["report"] = report.dump();
}

}  // namespace

Basis build_ddm_basis(const Character& character, const TrainOptions& options) {
  const Character ordered = in_order(character, morton_order(character.vertices));
  const double radius =
      options.smoothing_radius > 0 ? options.smoothing_radius : default_smoothing_radius(ordered.vertices);
  return make_base(ordered, radius, options).basis;
}

Basis train(const SampleSet& set, const TrainOptions& options) {
  check_samples(set);
  const SingleThreadedProducts single_threaded;
  const std::vector<std::uint32_t> order = morton_order(set.character.vertices);
  const Character ordered = in_order(set.character, order);
  Base base = choose_base(set, ordered, order, options);
  Basis& basis = base.basis;
  basis.strain = make_strain_table(basis, set.muscles);
  const Displacements displacements = unpose_all(set, basis, order);

  std::vector<const Pose*> poses;
  std::vector<int> takes;
  for (const Sample& sample : set.train) {
    poses.push_back(&sample.pose);
    takes.push_back(sample.take);
  }
  FeatureSamples features = measure_features(basis, poses);
  auto groups = make_feature_groups(basis, base.moments, set.muscles, features.values, displacements);
  const std::vector<RegionWeights> regions = make_regions(ordered, groups);
  if (options.joint_only_linear) {  // same regions, but nothing measured on the skin
    basis.strain = make_strain_table(basis, {});
    features = measure_features(basis, poses);
    groups = make_feature_groups(basis, base.moments, {}, features.values, displacements);
  }
  TrainOptions fit_options = options;
  if (options.match_bytes > 0) fit_options.components = std::max(options.components, kMostComponents);
  ResidualModel model = fit_residual(ordered, basis, regions, groups, features, displacements, takes, fit_options);
  model.controls = set.controls;
  const double mean_displacement =
      std::sqrt(3 * double{displacements.squaredNorm()} / static_cast<double>(displacements.size()));
  const double negligible = kNegligible * mean_displacement;
  if (options.match_bytes > 0) {
    pack_to_match(basis, model, fit_options.components, negligible, options);
  } else {
    basis.residual = pack_residual(model, options.components, negligible);
  }
  add_report(basis, set, options, model);
  return std::move(base.basis);
}

UnposingResidual unposing_residual(const SampleSet& set, const Basis& basis) {
  const std::vector<std::uint32_t> order = morton_order(set.character.vertices);
  const Character ordered = in_order(set.character, order);
  std::vector<double> lbs(set.train.size()), ddm(set.train.size());
  parallel_for(set.train.size(), [&](std::size_t n) {
    const Positions shape = in_order(set.train[n].shape, order);
    lbs[n] = unpose_linear(ordered, set.train[n].pose, shape).squaredNorm();
    ddm[n] = unpose_ddm(basis, set.train[n].pose, shape).squaredNorm();
  });
  UnposingResidual sum;
  for (std::size_t n = 0; n < set.train.size(); ++n) {
    sum.lbs += lbs[n];
    sum.ddm += ddm[n];
  }
  const double count = static_cast<double>(set.train.size()) * static_cast<double>(ordered.vertices.rows());
  if (count > 0) sum = {1e3 * std::sqrt(sum.lbs / count), 1e3 * std::sqrt(sum.ddm / count)};
  return sum;
}

}  // namespace bodyopt
