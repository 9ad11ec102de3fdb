#include "trainer/anatomy/field.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/content_hash.h"
#include "runtime/core/error.h"
#include "trainer/anatomy/muscle_paths.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double kLeastFat = 0.02, kMostFat = 0.6;

void check_options(const AnatomyOptions& options) {
  if (!(options.body_fat >= kLeastFat && options.body_fat <= kMostFat)) {
    throw Error(ErrorKind::usage, "body fat ", options.body_fat,
                ": expected a share of the body's mass, 0.02 to 0.6 (is it in percent?)");
  }
  if (!(options.cell >= 0) || !std::isfinite(options.cell))
    throw Error(ErrorKind::usage, "anatomy: the edge of a cell is ", options.cell, ", expected metres");
}

// Throws Error(mismatch) for a muscle that is corrected and not given; without muscles nothing of them counts.
void require_known(const AnatomyCorrections& corrections, const std::vector<Muscle>& muscles) {
  for (const auto& [name, of] : corrections.muscles) {
    const auto is_named = [&n = name](const Muscle& muscle) { return muscle.name == n; };
    if (muscles.empty() || std::ranges::any_of(muscles, is_named)) continue;
    throw Error(ErrorKind::mismatch, "the corrections name the muscle '", name, "', which is none of the ",
                muscles.size(), " given: misspelt?");
  }
}

// A number without a counterpart stands for itself.
std::vector<int> or_itself(std::vector<int> others) {
  for (std::size_t k = 0; k < others.size(); ++k) others[k] = others[k] < 0 ? static_cast<int>(k) : others[k];
  return others;
}

// The cells whose middles surround a point, and their weights in between; those without a sample have -1.
struct Corners {
  std::array<int, 8> sample;
  std::array<double, 8> weight;
  std::array<bool, 8> is_mirrored;  // the cell is the image of one beyond the median plane

  Corners(const AnatomyField::Half& half, const Vector3d& point) {
    const BodyGrid& grid = half.grid;
    const Vector3d at = (point - grid.low) / grid.cell - Vector3d::Constant(0.5);
    const Vector3d low = at.array().floor().max(-2).min(grid.count.cast<double>().array());
    for (int k = 0; k < 8; ++k) {
      const Vector3i step(k & 1, k >> 1 & 1, k >> 2);
      Vector3i cell = low.cast<int>() + step;
      const auto corner = static_cast<std::size_t>(k);
      is_mirrored[corner] = half.body.has_plane && cell.x() < 0;
      if (is_mirrored[corner]) cell.x() = -1 - cell.x();
      sample[corner] = grid.sample_at(cell);
      weight[corner] = 1;
      for (int axis = 0; axis < 3; ++axis) {
        const double up = at[axis] - low[axis];
        weight[corner] *= step[axis] == 1 ? up : 1 - up;
      }
    }
  }

  // How deep a point lies: below the planes that touch the skin at the points nearest to its samples.
  double depth(const BodyGrid& grid, const Vector3d& point) const {
    return mean([&](std::size_t k) {
      const Vector3d& skin = grid.skin[static_cast<std::size_t>(sample[k])].position;
      const Vector3d inwards = grid.points.row(sample[k]).transpose() - skin;
      const Vector3d from = (is_mirrored[k] ? Vector3d(-point.x(), point.y(), point.z()) : point) - skin;
      return weight[k] * from.dot(inwards) / std::max(inwards.norm(), 1e-12);
    });
  }
  double read(const Eigen::VectorXd& values) const {
    return mean([&](std::size_t k) { return weight[k] * values[sample[k]]; });
  }
  // The mean over those that have a sample; not a number where none has.
  template <typename Weighted>
  double mean(const Weighted& weighted) const {
    double sum = 0, weights = 0;
    for (std::size_t k = 0; k < 8; ++k) {
      if (sample[k] < 0) continue;
      sum += weighted(k);
      weights += weight[k];
    }
    return sum / weights;
  }
  // The sample that counts most of those that are wanted; -1: none is.
  template <typename Wanted>
  int nearest(const Wanted& wanted) const {
    int best = -1;
    double most = -1;
    for (std::size_t k = 0; k < 8; ++k) {
      if (sample[k] < 0 || weight[k] <= most || !wanted(sample[k])) continue;
      best = sample[k];
      most = weight[k];
    }
    return best;
  }
};

// The nearest lean sample of the muscle to which most of what surrounds the point belongs: borders between muscles do
// not follow the cells then.
int lean_sample(const AnatomyField::Half& half, const Corners& corners) {
  const auto is_lean = [&](int s) { return s >= 0 && half.tissue.kind(s) == TissueKind::other_lean; };
  const auto label = [&](int s) { return half.division.label[static_cast<std::size_t>(s)]; };
  int winner = -2;
  double most = 0;
  for (const int candidate : corners.sample) {
    if (!is_lean(candidate)) continue;
    double votes = 0;
    for (std::size_t k = 0; k < 8; ++k) {
      if (is_lean(corners.sample[k]) && label(corners.sample[k]) == label(candidate)) votes += corners.weight[k];
    }
    if (votes <= most) continue;
    most = votes;
    winner = label(candidate);
  }
  return corners.nearest([&](int s) { return is_lean(s) && label(s) == winner; });
}

// depth: of the point, which may lie nearer to the skin than all samples.
TissueAt tissue_in(const AnatomyField::Half& half, const Corners& corners, double depth) {
  const InnerTissue& tissue = half.tissue;
  if (corners.read(tissue.bone) < 0) {
    const int s = corners.nearest([&](int n) { return tissue.bone[n] < 0; });
    if (s >= 0) return {TissueKind::bone, tissue.bone_joint[static_cast<std::size_t>(s)], -1};
  }
  const double fat = corners.read(half.grid.depth) - corners.read(tissue.fat);
  if (depth < fat) return {TissueKind::fat};
  if (corners.read(tissue.cavity) < 0) return {TissueKind::cavity};
  const int s = lean_sample(half, corners);
  const int label = s < 0 ? -1 : half.division.label[static_cast<std::size_t>(s)];
  if (label < 0) return {TissueKind::other_lean};
  const int muscle = half.division.muscles[static_cast<std::size_t>(label)].muscle;
  return {half.division.is_tendon[static_cast<std::size_t>(s)] ? TissueKind::tendon : TissueKind::muscle, -1, muscle};
}

}  // namespace

AnatomyField::AnatomyField(const Character& character, const std::vector<Muscle>& muscles,
                           const AnatomyOptions& options) {
  check_options(options);
  require_fit(muscles, character.skeleton);
  require_known(options.corrections, muscles);
  const RecognisedKind recognised = recognise_kind(character);
  kind_ = options.kind.value_or(recognised.kind);
  why_kind_ = options.kind ? "as asked for" : recognised.why;
  const double cell = options.cell > 0 ? options.cell : default_cell(character);
  for (HalfBody& body : halves_of(character, kind_)) {
    Half half;
    half.body = std::move(body);
    half.grid = sample_body(half.body, cell);
    half.tissue = find_inner_tissue(half.body, half.grid, {options.body_fat, kind_, options.corrections});
    half.division = divide_muscles(half.body, half.grid, half.tissue, muscles, options.corrections);
    half.joint = or_itself(mirrored_joints(character));
    half.muscle = or_itself(mirrored_muscles(half.body, muscles));
    halves_.push_back(std::move(half));
  }
  belly_lengths_.assign(muscles.size(), 0);
  for (const Half& half : halves_) {
    for (const Division::OfMuscle& of : half.division.muscles) {
      const double belly = (of.belly_to - of.belly_from) * path_length(of.path);
      for (const int slip : of.slips) {
        const auto m = static_cast<std::size_t>(slip);
        belly_lengths_[m] = belly;
        if (is_own_mirror()) belly_lengths_[static_cast<std::size_t>(half.muscle[m])] = belly;
      }
    }
  }
}

AnatomyField::Place AnatomyField::place_of(const Vector3d& point) const {
  Place place{&halves_.front(), halves_.front().body.from_rest * point, false};
  if (!place.half->body.has_plane || !(place.point.x() < 0)) return place;
  if (!is_own_mirror()) return {&halves_[1], halves_[1].body.from_rest * point, false};
  place.point.x() = -place.point.x();
  place.is_other_side = true;
  return place;
}

TissueAt AnatomyField::tissue_at(const Vector3d& point) const {
  if (halves_.empty() || !point.allFinite()) return {};
  const Place place = place_of(point);
  const Corners corners(*place.half, place.point);
  const double depth = corners.depth(place.half->grid, place.point);
  if (!(depth > 0)) return {};
  TissueAt at = tissue_in(*place.half, corners, depth);
  if (place.is_other_side && at.joint >= 0) at.joint = place.half->joint[static_cast<std::size_t>(at.joint)];
  if (place.is_other_side && at.muscle >= 0) at.muscle = place.half->muscle[static_cast<std::size_t>(at.muscle)];
  return at;
}

Vector3d AnatomyField::fibre_at(const Vector3d& point) const {
  if (halves_.empty() || !point.allFinite()) return Vector3d::Zero();
  const Place place = place_of(point);
  const int s = lean_sample(*place.half, Corners(*place.half, place.point));
  if (s < 0 || tissue_at(point).muscle < 0) return Vector3d::Zero();
  Vector3d fibre = place.half->division.fibre.row(s);
  if (place.is_other_side) fibre.x() = -fibre.x();
  return place.half->body.from_rest.linear().transpose() * fibre;
}

std::vector<int> AnatomyField::slips_of(int muscle) const {
  for (const Half& half : halves_) {
    for (const Division::OfMuscle& of : half.division.muscles) {
      if (of.slips.empty()) continue;
      if (of.muscle == muscle) return of.slips;
      if (!is_own_mirror() || half.muscle[static_cast<std::size_t>(of.muscle)] != muscle) continue;
      std::vector<int> slips;
      for (const int slip : of.slips) slips.push_back(half.muscle[static_cast<std::size_t>(slip)]);
      return slips;
    }
  }
  return {muscle};
}

std::uint64_t AnatomyField::hash() const {
  ContentHash hash;
  const auto add_array = [&](const Eigen::VectorXd& values) {
    hash.append(values.data(), static_cast<std::size_t>(values.size()) * sizeof(double));
  };
  const auto add_ints = [&](const std::vector<int>& values) {
    hash.append(values.data(), values.size() * sizeof(int));
  };
  for (const Half& half : halves_) {
    hash.add(static_cast<std::uint64_t>(half.grid.size()));
    hash.append(half.body.from_rest.matrix().data(), 16 * sizeof(double));
    hash.add(half.grid.cell);
    for (int axis = 0; axis < 3; ++axis) hash.add(half.grid.low[axis]);
    add_ints(half.grid.sample);
    for (const Eigen::VectorXd* values : {&half.tissue.bone, &half.tissue.fat, &half.tissue.cavity}) add_array(*values);
    for (const std::vector<int>* values : {&half.tissue.bone_joint, &half.division.label, &half.joint, &half.muscle})
      add_ints(*values);
    for (const bool is_tendon : half.division.is_tendon) hash.add(std::uint64_t{is_tendon});
    hash.append(half.division.fibre.data(), static_cast<std::size_t>(half.division.fibre.size()) * sizeof(double));
    for (const Division::OfMuscle& of : half.division.muscles) hash.add(static_cast<std::uint64_t>(of.muscle));
  }
  for (const double length : belly_lengths_) hash.add(length);
  return hash.value();
}

}  // namespace bodyopt::trainer
