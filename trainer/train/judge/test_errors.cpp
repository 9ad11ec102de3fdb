#include "trainer/train/judge/test_errors.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "base/linear_algebra.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/spread_evenly.h"
#include "dataset/dataset.h"
#include "geometry/mesh.h"
#include "geometry/surface_distance.h"
#include "runtime/core/error.h"
#include "runtime/core/stopwatch.h"
#include "runtime/core/transformed.h"
#include "runtime/coverage/expected_error.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "trainer/train/coverage/coverage.h"
#include "trainer/train/data/learned_poses.h"
#include "trainer/train/data/unposed_shapes.h"
#include "trainer/train/pack/trade_off.h"
#include "trainer/train/skinning/ddm.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::trainer {
namespace {

// Whether the frame at this place of its take, from 0, is held out.
bool is_held_out(std::size_t place, int every) {
  constexpr std::size_t kBlock = 10;
  return (place / kBlock) % static_cast<std::size_t>(every) == static_cast<std::size_t>(every) - 1;
}

// The samples of a take are numbered in steps of its frame spacing, so that every second frame still counts as
// consecutive. Takes are set far apart.
std::vector<int> sample_numbers(const std::vector<Sample>& samples) {
  std::map<int, int> spacing;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    if (samples[k].take != samples[k - 1].take) continue;
    int& step = spacing[samples[k].take];
    step = std::gcd(step, samples[k].frame - samples[k - 1].frame);
  }
  return transformed(samples, [&](const Sample& sample) {
    return sample.take * 10'000'000 + sample.frame / std::max(1, spacing[sample.take]);
  });
}

using Index = Eigen::Index;
using Squares = Eigen::Matrix<double, Eigen::Dynamic, 3>;  // V or parts x (ddm, full, expected), mm^2

// Square metres of skin that each joint has of each vertex, V x joints.
Eigen::SparseMatrix<double> skin_of_joints(const Character& character) {
  const Eigen::VectorXd areas = lumped_areas(character.vertices, character.triangles);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t v = 0; v < character.weights.size(); ++v) {
    for (const JointWeight& w : character.weights[v]) {
      entries.emplace_back(static_cast<int>(v), static_cast<int>(w.joint), w.weight * areas[static_cast<Index>(v)]);
    }
  }
  return sparse_matrix(static_cast<Index>(character.weights.size()), static_cast<Index>(character.skeleton.size()),
                       entries);
}

MethodErrors errors_of(const Eigen::RowVector3d& squares, double weight) {
  if (!(weight > 0)) return {};
  return {std::sqrt(squares[0] / weight), std::sqrt(squares[1] / weight), std::sqrt(squares[2] / weight)};
}

// Evaluates frames, and says of each vertex how far they are off.
class Tester {
 public:
  Tester(const Basis& basis, const SampleSet& set)
      : character_(set.character), full_(basis, {.name = "cpu"}), ddm_(without_residual(basis), {.name = "cpu"}) {
    if (basis.coverage.empty()) return;
    expectation_.emplace(full_.basis());
    shares_ = RegionShares(basis);
  }

  Squares squares(const Sample& sample, FrameErrors& frame) {
    Pose pose = sample.pose;
    if (full_.basis().residual.controls.empty()) pose.controls.clear();  // a basis that has learned none
    const Evaluation full = full_.evaluate({&pose, 1});
    const Positions truth = sample.shape.read();
    Squares squares(truth.rows(), 3);
    pose.controls.clear();
    squares.col(0) = squared_mm(ddm_.evaluate({&pose, 1}).positions, truth);
    squares.col(1) = squared_mm(full.positions, truth);
    squares.col(2) = expected_squares(full);
    frame.fade = mean_fade(full, 0);
    if (full.fading_joint[0] >= 0) {
      frame.fading_joint = full_.basis().skeleton.joints[static_cast<std::size_t>(full.fading_joint[0])].name;
    }
    return squares;
  }

 private:
  Eigen::VectorXd squared_mm(const std::vector<float>& positions, const Positions& truth) const {
    return 1e6 * (welded_from_output(character_, positions.data()) - truth).rowwise().squaredNorm();
  }

  Eigen::VectorXd expected_squares(const Evaluation& full) const {
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(character_.vertices.rows());
    if (!expectation_) return squares;
    const Basis& basis = full_.basis();
    const std::vector<float> metres = shares_.carry(expectation_->of(full, 0).region_mm);
    for (std::size_t o = 0; o < character_.output_vertex.size(); ++o) {
      squares[character_.output_vertex[o]] = 1e6 * std::pow(double{metres[basis.mesh.output_vertex[o]]}, 2);
    }
    return squares;
  }

  const Character& character_;
  Deformer full_, ddm_;
  std::optional<ErrorExpectation> expectation_;
  RegionShares shares_;
};

// Sums over the frames of one take.
class TakeSums {
 public:
  explicit TakeSums(const Eigen::SparseMatrix<double>& skin) : skin_(skin) {
    areas_ = skin.transpose() * Eigen::VectorXd::Ones(skin.rows());
    sums_ = Squares::Zero(skin.cols(), 3);
  }

  void add(FrameErrors frame, const Squares& squares) {
    const Squares parts = skin_.transpose() * squares;
    sums_ += parts;
    frame.errors = errors_of(parts.colwise().sum(), areas_.sum());
    frames_.push_back(std::move(frame));
    for (Index j = 0; j < parts.rows(); ++j) {
      if (!(areas_[j] > 0)) continue;
      const MethodErrors errors = errors_of(parts.row(j), areas_[j]);
      expected_.push_back(errors.expected);
      measured_.push_back(errors.full);
    }
  }

  bool empty() const { return frames_.empty(); }

  TakeErrors finish(const std::string& name, const Skeleton& skeleton) const {
    TakeErrors take{name, {}, {}, frames_, rank_correlation(expected_, measured_)};
    const auto count = static_cast<double>(frames_.size());
    take.errors = errors_of(sums_.colwise().sum(), count * areas_.sum());
    for (Index j = 0; j < areas_.size(); ++j) {
      if (!(areas_[j] > 0)) continue;
      take.parts.push_back(
          {skeleton.joints[static_cast<std::size_t>(j)].name, areas_[j], errors_of(sums_.row(j), count * areas_[j])});
    }
    return take;
  }

 private:
  const Eigen::SparseMatrix<double>& skin_;
  Eigen::VectorXd areas_;
  Squares sums_;
  std::vector<FrameErrors> frames_;
  std::vector<double> expected_, measured_;
};

using Support = Method::Support;
using Unposing = Method::Unposing;

// Per region, of methods that need them to make use of their bytes: linear maps, and components of the whole skin.
constexpr int kManyComponents = 128;

struct NamedMethod {
  const char* name;
  Method method;
};

constexpr NamedMethod kMethods[] = {
    {"LBS + joints, linear, dense", {Unposing::lbs, Support::whole_skin, false, false}},         // as SMPL
    {"LBS + joints, linear, local", {Unposing::lbs, Support::static_regions, false, false}},     // as STAR
    {"LBS + joints, kernels, dense", {Unposing::lbs, Support::whole_skin, false, true}},         // as DCC tools
    {"LBS + strains, kernels, dynamic", {Unposing::lbs, Support::dynamic_regions, true, true}},  // full, but un-posing
    {"DDM + joints, linear, dense", {Unposing::ddm, Support::whole_skin, false, false}},
    {"DDM + joints, linear, local", {Unposing::ddm, Support::static_regions, false, false}},
    {"DDM + joints, kernels, static", {Unposing::ddm, Support::static_regions, false, true}},
    {"DDM + strains, kernels, dense", {Unposing::ddm, Support::whole_skin, true, true}},
    {"DDM + strains, kernels, static", {Unposing::ddm, Support::static_regions, true, true}},
};

// A joint index and a weight, four bytes each.
double lbs_bytes_per_vertex(const Character& character) {
  double weights = 0;
  for (const auto& row : character.weights) weights += static_cast<double>(row.size());
  return 8 * weights / static_cast<double>(character.weights.size());
}

// Shapes by a basis that was trained on linear un-posing. The deformer adds its displacement before Direct Delta Mush;
// taken out again, it is added before linear blending.
std::vector<Positions> heldout_by_corrected_lbs(const SampleSet& set, const Basis& basis) {
  const std::vector<std::uint32_t> order = morton_order(set.character.vertices);
  Deformer deformer(basis, {.name = "cpu"});
  std::vector<Positions> shapes = heldout_by_basis(set, deformer);
  Character moved = set.character;
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const Pose& pose = set.heldout[k].pose;
    const Positions delta = unpose_ddm(basis, pose, in_order(shapes[k], order));
    for (std::size_t v = 0; v < order.size(); ++v) {
      moved.vertices.row(order[v]) = set.character.vertices.row(order[v]) + delta.row(static_cast<Eigen::Index>(v));
    }
    shapes[k] = skin_linear(moved, pose);
  }
  return shapes;
}

MethodResult row_of(const std::string& name, const SampleSet& set, const Basis& basis, double seconds) {
  Deformer deformer(basis, {.name = "cpu"});
  return {name, heldout_errors(set.heldout, heldout_by_basis(set, deformer)), bytes_per_vertex(basis),
          basis.residual.coefficient_count(), seconds};
}

// `spared_bytes`: of every vertex, what linear blending takes less than Direct Delta Mush.
MethodResult row_of(const NamedMethod& named, const SampleSet& set, TrainOptions options, double spared_bytes) {
  const Stopwatch watch;
  options.method = named.method;
  if (!named.method.kernels || named.method.support == Support::whole_skin) {
    options.components = std::max(options.components, kManyComponents);
  }
  // The basis that is trained has the table of Direct Delta Mush; linear blending does without.
  if (named.method.unposing == Unposing::lbs) options.budget += spared_bytes;
  const Basis basis = train(set, options).basis;
  const double seconds = watch.seconds();
  if (named.method.unposing == Unposing::ddm) return row_of(named.name, set, basis, seconds);
  const auto tables = table_bytes(basis);
  const auto learned = static_cast<double>(tables.at("strain") + tables.at("residual"));
  return {named.name, heldout_errors(set.heldout, heldout_by_corrected_lbs(set, basis)),
          lbs_bytes_per_vertex(set.character) + learned / basis.mesh.vertex_count(), basis.residual.coefficient_count(),
          seconds};
}

}  // namespace

void hold_out_blocks(Dataset& dataset, int every) {
  for (DatasetTake& take : dataset.takes) {
    take.heldout.clear();
    for (std::size_t k = 0; k < take.frames.size(); ++k) {
      if (is_held_out(k, every)) take.heldout.push_back(take.frames[k]);
    }
  }
}

std::string how_to_hold_out(const SampleSet& set) {
  for (int every = 5; every >= 2; --every) {
    const auto heldout = static_cast<std::size_t>(std::count_if(
        set.train.begin(), set.train.end(), [&](const Sample& sample) { return is_held_out(sample.place, every); }));
    if (heldout == 0 || set.train.size() - heldout < kFewestFrames) continue;
    return "train --heldout-every " + std::to_string(every) + " holds out " + std::to_string(heldout) + " of the " +
           std::to_string(set.train.size()) + " frames";
  }
  return "the takes are too short for --heldout-every: simulate another clip into the dataset with --heldout all";
}

std::vector<Positions> heldout_by_lbs(const SampleSet& set) {
  return transformed(set.heldout, [&](const Sample& sample) { return skin_linear(set.character, sample.pose); });
}

std::vector<Positions> heldout_by_basis(const SampleSet& set, Deformer& deformer) {
  std::vector<Positions> shapes;
  for (const Sample& sample : set.heldout) {
    Pose pose = sample.pose;
    if (deformer.basis().residual.controls.empty()) pose.controls.clear();  // a basis that has learned none
    const Evaluation evaluation = deformer.evaluate({&pose, 1});
    shapes.push_back(welded_from_output(set.character, evaluation.positions.data()));
  }
  return shapes;
}

ErrorStatistics heldout_errors(const std::vector<Sample>& heldout, const std::vector<Positions>& shapes) {
  if (shapes.empty()) return {};
  ErrorAccumulator accumulator(static_cast<std::uint32_t>(shapes.front().rows()));
  const std::vector<int> numbers = sample_numbers(heldout);
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    accumulator.add(numbers[k], floats_of(shapes[k]), floats_of(heldout[k].shape.read()));
  }
  return accumulator.finish();
}

VertexErrors vertex_errors(const SampleSet& set, const std::vector<Positions>& shapes) {
  VertexErrors errors;
  errors.mean = errors.mean_square = Eigen::VectorXd::Zero(set.character.vertices.rows());
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const Eigen::VectorXd squares = 1e6 * (shapes[k] - set.heldout[k].shape.read()).rowwise().squaredNorm();
    errors.mean += squares.cwiseSqrt() / static_cast<double>(shapes.size());
    errors.mean_square += squares / static_cast<double>(shapes.size());
  }
  return errors;
}

double region_rms(const VertexErrors& errors, const RegionWeights& region) {
  return std::sqrt(mean_over(region, [&](std::size_t k) { return errors.mean_square[region.vertices[k]]; }));
}

Basis without_residual(const Basis& basis) {
  Basis bare = basis;
  bare.strain = {};
  bare.residual = {};
  bare.coverage = {};
  bare.residual.blend_begin.assign(basis.mesh.block_count() + 1, 0);
  bare.strain.fibre_begin = {0};
  return bare;
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

std::vector<TakeErrors> test_errors(const Basis& basis, const SampleSet& set) {
  return test_errors(basis, set, set.heldout.empty() ? set.train : set.heldout);
}

std::vector<TakeErrors> test_errors(const Basis& basis, const SampleSet& set, const std::vector<Sample>& samples) {
  const Character ordered = in_order(set.character, morton_order(set.character.vertices));
  require_same_character(make_mesh_table(ordered), ordered.skeleton, basis);
  const Eigen::SparseMatrix<double> skin = skin_of_joints(set.character);
  Tester tester(basis, set);
  const LearnedPoses learned(basis, set);
  std::vector<TakeSums> sums(set.takes.size(), TakeSums(skin));
  Progress progress("test", samples.size());
  for (const Sample& sample : samples) {
    FrameErrors frame;
    frame.frame = sample.frame;
    frame.learned = learned.has(sample.pose);
    const Squares squares = tester.squares(sample, frame);
    sums[static_cast<std::size_t>(sample.take)].add(std::move(frame), squares);
    progress.advance();
  }
  std::vector<TakeErrors> takes;
  for (std::size_t k = 0; k < sums.size(); ++k) {
    if (!sums[k].empty()) takes.push_back(sums[k].finish(set.takes[k], set.character.skeleton));
  }
  return takes;
}

std::vector<PartErrors> harmed_parts(const TakeErrors& take, double share) {
  std::vector<PartErrors> harmed;
  for (const PartErrors& part : take.parts) {
    if (part.errors.full > (1 + share) * part.errors.ddm) harmed.push_back(part);
  }
  return harmed;
}

std::vector<MethodResult> compare_with_skinning(const SampleSet& set, const Basis& full, double seconds) {
  return {{"LBS", heldout_errors(set.heldout, heldout_by_lbs(set)), lbs_bytes_per_vertex(set.character), 0, 0},
          row_of("DDM", set, without_residual(full), 0),
          row_of("full: DDM + strains, kernels, dynamic", set, full, seconds)};
}

std::vector<MethodResult> ablate(const SampleSet& set, const TrainOptions& options, const TrainingResult& full,
                                 double seconds, std::vector<std::string>& unmade) {
  std::vector<MethodResult> rows = compare_with_skinning(set, full.basis, seconds);
  TrainOptions matched = options;
  matched.smoothing_radius = full.smoothing_radius;  // chosen by the same frames, each would find it again
  matched.budget = bytes_per_vertex(full.basis);
  const double spared = bytes_per_vertex(without_residual(full.basis)) - lbs_bytes_per_vertex(set.character);
  matched.tolerance_mm = 0;
  matched.keep_in.clear();  // that is for the full model
  matched.update = false;
  for (const NamedMethod& named : kMethods) {
    try {
      rows.insert(rows.end() - 1, row_of(named, set, matched, spared));
    } catch (const Error& error) {
      // Options that served the full model can ask too much of another in their budget alone.
      if (error.kind() != ErrorKind::usage) throw;
      unmade.push_back(named.name);
    }
  }
  return rows;
}

}  // namespace bodyopt::trainer
