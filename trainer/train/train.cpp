#include "trainer/train/train.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "runtime/basis/error.h"
#include "trainer/progress.h"
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
// A basis entry that moves its vertex by less, metres for a character of 1.8 m, root mean square, is left out.
constexpr double kNegligible = 1e-5;

// Matrix products on one thread: their sums must not depend on how many there are. Loops over frames, joints and
// regions are what runs in parallel.
class SingleThreadedProducts {
 public:
  SingleThreadedProducts() : threads_(Eigen::nbThreads()) { Eigen::setNbThreads(1); }
  ~SingleThreadedProducts() { Eigen::setNbThreads(threads_); }

 private:
  int threads_;
};

std::string hexadecimal(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(value));
  return text;
}

DdmOptions ddm_options(const Character& ordered, const TrainOptions& options) {
  DdmOptions ddm;
  ddm.radius = options.smoothing_radius > 0 ? options.smoothing_radius : default_smoothing_radius(ordered.vertices);
  ddm.steps = options.smoothing_steps;
  return ddm;
}

// `ordered`: the character in runtime order.
Basis bare_basis(const Character& ordered, const std::vector<VertexMoments>& moments, const TrainOptions& options) {
  Basis basis;
  basis.skeleton = ordered.skeleton;
  basis.mesh = make_mesh_table(ordered);
  basis.ddm = pack_ddm(moments);
  basis.strain.fibre_begin = {0};
  basis.residual.blend_begin.assign(basis.mesh.vertex_count() + 1, 0);
  const DdmOptions ddm = ddm_options(ordered, options);
  basis.metadata["units"] = "metres";
  basis.metadata["topology_hash"] = hexadecimal(topology_hash(basis.mesh));
  basis.metadata["skeleton_hash"] = hexadecimal(skeleton_hash(basis.skeleton));
  const nlohmann::json provenance = {{"program", "bodyopt"},
                                     {"character", ordered.name},
                                     {"smoothing_radius_m", ddm.radius},
                                     {"smoothing_steps", ddm.steps},
                                     {"seed", options.seed}};
  basis.metadata["provenance"] = provenance.dump();
  return basis;
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
}

std::vector<std::uint32_t> runtime_order(const Character& character) { return morton_order(character.vertices); }

Displacements unpose_all(const SampleSet& set, const Basis& basis, const std::vector<std::uint32_t>& order) {
  Displacements displacements(static_cast<Eigen::Index>(set.train.size()), 3 * basis.mesh.vertex_count());
  Progress progress("train: un-posing", set.train.size());
  parallel_for(set.train.size(), [&](std::size_t n) {
    const Positions delta = unpose_ddm(basis, set.train[n].pose, in_order(set.train[n].shape, order));
    displacements.row(static_cast<Eigen::Index>(n)) =
        Eigen::Map<const Eigen::RowVectorXd>(delta.data(), delta.size()).cast<float>();
#pragma omp critical(bodyopt_progress)
    progress.advance();
  });
  return displacements;
}

std::size_t residual_bytes(const Basis& basis) { return table_bytes(basis).at("residual"); }

// The residual with the fewest components per region whose table has `bytes` bytes, or with all of them.
void pack_to_match(Basis& basis, const ResidualModel& model, int components, double negligible, std::size_t bytes) {
  int low = 1, high = components;
  while (low < high) {
    const int middle = (low + high) / 2;
    basis.residual = pack_residual(model, middle, negligible);
    if (residual_bytes(basis) >= bytes) {
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
  const Character ordered = in_order(character, runtime_order(character));
  const auto moments = ddm_moments(ordered.vertices, ordered.triangles, ordered.weights, ddm_options(ordered, options));
  return bare_basis(ordered, moments, options);
}

Basis train(const SampleSet& set, const TrainOptions& options) {
  check_samples(set);
  const SingleThreadedProducts single_threaded;
  const std::vector<std::uint32_t> order = runtime_order(set.character);
  const Character ordered = in_order(set.character, order);
  const auto moments = ddm_moments(ordered.vertices, ordered.triangles, ordered.weights, ddm_options(ordered, options));
  Basis basis = bare_basis(ordered, moments, options);
  basis.strain = make_strain_table(basis, set.muscles);
  const Displacements displacements = unpose_all(set, basis, order);

  std::vector<const Pose*> poses;
  std::vector<int> takes;
  for (const Sample& sample : set.train) {
    poses.push_back(&sample.pose);
    takes.push_back(sample.take);
  }
  FeatureSamples features = measure_features(basis, poses);
  const auto groups = make_feature_groups(basis, moments, set.muscles, features.values, displacements);
  const std::vector<RegionWeights> regions = make_regions(ordered, groups);
  if (options.joint_only_linear) {  // same regions, but nothing measured on the skin
    basis.strain = make_strain_table(basis, {});
    features = measure_features(basis, poses);
  }
  TrainOptions fit_options = options;
  if (options.match_bytes > 0) fit_options.components = std::max(options.components, kMostComponents);
  ResidualModel model = fit_residual(ordered, basis, regions, groups, features, displacements, takes, fit_options);
  for (std::size_t k = 0; k < poses[0]->controls.size(); ++k) {
    model.controls.push_back("control" + std::to_string(k + 1));
  }
  const double negligible = kNegligible * longest_extent(ordered.vertices) / 1.8;
  if (options.match_bytes > 0) {
    pack_to_match(basis, model, fit_options.components, negligible, options.match_bytes);
    if (residual_bytes(basis) < options.match_bytes) {  // every entry, then
      pack_to_match(basis, model, fit_options.components, 0, options.match_bytes);
    }
  } else {
    basis.residual = pack_residual(model, options.components, negligible);
  }
  add_report(basis, set, options, model);
  return basis;
}

UnposingResidual unposing_residual(const SampleSet& set, const Basis& basis) {
  const std::vector<std::uint32_t> order = runtime_order(set.character);
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
