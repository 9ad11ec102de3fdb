#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/quantile.h"
#include "trainer/anatomy/division.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kOuterShare = 0.07;
constexpr int kMostSteps = 600, kMixings = 2, kFillings = 20;
constexpr double kResidual = 1e-6;  // of the right-hand side

// One muscle's samples, numbered among themselves.
struct MuscleRegion {
  std::vector<int> sample;                     // N: lean samples
  std::vector<std::array<int, 6>> neighbours;  // N: in `sample`, -1: of another
  VectorXd along;                              // N
};

std::vector<MuscleRegion> muscle_regions(const LeanSamples& lean, std::size_t muscles, const std::vector<int>& label,
                                         const std::vector<double>& along) {
  std::vector<MuscleRegion> regions(muscles);
  std::vector<int> number(lean.size(), -1);
  for (std::size_t i = 0; i < lean.size(); ++i) {
    if (label[i] < 0) continue;
    auto& samples = regions[static_cast<std::size_t>(label[i])].sample;
    number[i] = static_cast<int>(samples.size());
    samples.push_back(static_cast<int>(i));
  }
  for (MuscleRegion& region : regions) {
    region.along.resize(static_cast<Index>(region.sample.size()));
    for (std::size_t k = 0; k < region.sample.size(); ++k) {
      const auto i = static_cast<std::size_t>(region.sample[k]);
      region.along[static_cast<Index>(k)] = along[i];
      region.neighbours.push_back(lean.neighbours[i]);
      for (int& beside : region.neighbours.back()) {
        if (beside < 0) continue;
        const auto j = static_cast<std::size_t>(beside);
        beside = label[j] == label[i] ? number[j] : -1;
      }
    }
  }
  return regions;
}

// Does a sample share a face with the bone of a joint?
bool touches_bone(const LeanSamples& lean, int lean_sample, int joint) {
  return std::ranges::any_of(lean.grid.beside(lean.sample[static_cast<std::size_t>(lean_sample)]), [&](int other) {
    return other >= 0 && lean.tissue.kind(other) == TissueKind::bone &&
           lean.tissue.bone_joint[static_cast<std::size_t>(other)] == joint;
  });
}

// N: 0 at the origin, 1 at the insertion, -1 in between.
VectorXd held_values(const LeanSamples& lean, const MuscleRegion& region, const std::array<int, 2>& joints) {
  VectorXd held = VectorXd::Constant(region.along.size(), -1);
  const double middle = quantile(region.along, 0.5);
  for (const int end : {0, 1}) {
    bool has_contact = false;
    for (Index k = 0; k < held.size(); ++k) {
      const bool is_in_half = end == 0 ? region.along[k] < middle : region.along[k] > middle;
      if (!is_in_half ||
          !touches_bone(lean, region.sample[static_cast<std::size_t>(k)], joints[static_cast<std::size_t>(end)]))
        continue;
      held[k] = end;
      has_contact = true;
    }
    if (has_contact) continue;
    const double border = quantile(region.along, end == 0 ? kOuterShare : 1 - kOuterShare);
    for (Index k = 0; k < held.size(); ++k) {
      if (end == 0 ? region.along[k] <= border : region.along[k] >= border) held[k] = end;
    }
  }
  return held;
}

// The graph Laplacian of the free samples; zero on those that are held.
VectorXd laplacian_of(const MuscleRegion& region, const VectorXd& held, const VectorXd& values) {
  VectorXd result = VectorXd::Zero(values.size());
  for (Index k = 0; k < values.size(); ++k) {
    if (held[k] >= 0) continue;
    for (const int beside : region.neighbours[static_cast<std::size_t>(k)]) {
      if (beside >= 0) result[k] += values[k] - values[beside];
    }
  }
  return result;
}

// Conjugate gradients find it, from the place along the path.
VectorXd harmonic(const MuscleRegion& region, const VectorXd& held) {
  VectorXd values = (held.array() >= 0).select(held, region.along);
  VectorXd residual = -laplacian_of(region, held, values), way = residual;
  double squared = residual.squaredNorm();
  const double enough = kResidual * kResidual * squared;
  for (int step = 0; step < kMostSteps && squared > enough; ++step) {
    const VectorXd bent = laplacian_of(region, held, way);
    const double bend = way.dot(bent);
    if (!(bend > 0)) break;
    const double length = squared / bend;
    values += length * way;
    residual -= length * bent;
    const double next = residual.squaredNorm();
    way = residual + next / squared * way;
    squared = next;
  }
  return values;
}

Positions gradient(const MuscleRegion& region, const VectorXd& values) {
  Positions result = Positions::Zero(values.size(), 3);
  for (Index k = 0; k < values.size(); ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto& beside = region.neighbours[static_cast<std::size_t>(k)];
      const int before = beside[static_cast<std::size_t>(2 * axis)],
                after = beside[static_cast<std::size_t>(2 * axis + 1)];
      const int cells = (before >= 0 ? 1 : 0) + (after >= 0 ? 1 : 0);
      if (cells == 0) continue;
      result(k, axis) = (values[after >= 0 ? after : k] - values[before >= 0 ? before : k]) / cells;
    }
  }
  return result;
}

// Adds to each sample its neighbours' mean direction with equal weight; only_empty: to those without a direction alone.
Positions mixed_with_neighbours(const MuscleRegion& region, const Positions& ways, bool only_empty) {
  Positions result = ways;
  for (Index k = 0; k < ways.rows(); ++k) {
    if (only_empty && ways.row(k).squaredNorm() > 0) continue;
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    for (const int beside : region.neighbours[static_cast<std::size_t>(k)]) {
      if (beside >= 0) sum += ways.row(beside);
    }
    result.row(k) = (ways.row(k) + sum / std::max(sum.norm(), 1e-12)).stableNormalized();
  }
  return result;
}

Positions ways_of(const LeanSamples& lean, const HalfMuscle& muscle, const MuscleRegion& region,
                  const std::array<int, 2>& joints) {
  const VectorXd held = held_values(lean, region, joints);
  Positions ways = gradient(region, harmonic(region, held));
  const double flat = 1e-6;  // of a gradient, against one over the muscle's length
  for (Index k = 0; k < ways.rows(); ++k) {
    const double steep = ways.row(k).norm();
    ways.row(k) *= steep > flat * lean.grid.cell / path_length(muscle.path) ? 1 / steep : 0;
  }
  for (int pass = 0; pass < kFillings; ++pass) ways = mixed_with_neighbours(region, ways, true);
  for (Index k = 0; k < ways.rows(); ++k) {
    if (ways.row(k).squaredNorm() > 0) continue;
    const auto at = std::clamp<Index>(std::lround(region.along[k] * (kPathPoints - 1)), 1, kPathPoints - 2);
    ways.row(k) = (muscle.path.row(at + 1) - muscle.path.row(at - 1)).stableNormalized();
  }
  for (int pass = 0; pass < kMixings; ++pass) ways = mixed_with_neighbours(region, ways, false);
  return ways;
}

}  // namespace

Positions fibre_directions(const LeanSamples& lean, const std::vector<HalfMuscle>& muscles,
                           const std::vector<std::array<int, 2>>& joints, const std::vector<int>& label,
                           const std::vector<double>& along) {
  Positions directions = Positions::Zero(static_cast<Index>(lean.size()), 3);
  const std::vector<MuscleRegion> regions = muscle_regions(lean, muscles.size(), label, along);
  parallel_for(muscles.size(), [&](std::size_t m) {
    if (regions[m].sample.empty()) return;
    directions(regions[m].sample, Eigen::all) = ways_of(lean, muscles[m], regions[m], joints[m]);
  });
  return directions;
}

}  // namespace bodyopt::trainer
