#include "trainer/train/judge/heldout.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/parallel.h"
#include "base/spread_evenly.h"
#include "dataset/dataset.h"
#include "geometry/table_rows.h"
#include "runtime/basis/basis.h"
#include "runtime/core/transformed.h"
#include "runtime/deformer/deformer.h"
#include "trainer/train/data/unposed_shapes.h"
#include "trainer/train/skinning/linear_blend.h"
#include "trainer/train/skinning/mesh_table.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt {
namespace {

// Of the frame at this place of its take, from 0.
bool is_held_out(std::size_t place, int every) {
  constexpr std::size_t kBlock = 10;
  return (place / kBlock) % static_cast<std::size_t>(every) == static_cast<std::size_t>(every) - 1;
}

// The samples of a take are numbered in steps of its frame spacing, so that every second frame still counts as
// consecutive; takes are set far apart.
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

}  // namespace bodyopt
