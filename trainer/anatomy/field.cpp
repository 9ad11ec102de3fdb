#include "trainer/anatomy/field.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/content_hash.h"
#include "runtime/core/error.h"
#include "trainer/anatomy/muscle_paths.h"

namespace bodyopt {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double kLeastFat = 0.02, kMostFat = 0.6;
constexpr double kMuscleStress = 180e3;  // pascals at full activation

void check_options(const AnatomyOptions& options) {
  if (!(options.body_fat >= kLeastFat && options.body_fat <= kMostFat)) {
    throw Error(ErrorKind::usage, "body fat " + std::to_string(options.body_fat) +
                                      ": expected a share of the body's mass, 0.02 to 0.6 (is it in percent?)");
  }
  if (!(options.cell >= 0) || !std::isfinite(options.cell))
    throw Error(ErrorKind::usage,
                "anatomy: the edge of a cell is " + std::to_string(options.cell) + ", expected metres");
}

void require_fit(const Character& character, const std::vector<Muscle>& muscles) {
  if (character.skeleton.size() == 0) throw Error(ErrorKind::mismatch, "the character has no joints to drive it");
  for (const Muscle& muscle : muscles) {
    if (muscle.path.size() < 2 || !(muscle.radius > 0)) {
      throw Error(ErrorKind::mismatch, "muscle '" + muscle.name + "' needs two points or more and a radius above 0");
    }
    for (const MusclePoint& point : muscle.path) {
      if (point.joint < character.skeleton.size()) continue;
      throw Error(ErrorKind::mismatch, "muscle '" + muscle.name + "' is bound to a joint the skeleton lacks");
    }
  }
}

// The number of each muscle on the other side; its own where that has none.
std::vector<int> other_muscles(const HalfBody& body, const std::vector<Muscle>& muscles) {
  std::vector<int> others = mirrored_muscles(body, muscles);
  for (std::size_t m = 0; m < others.size(); ++m) others[m] = others[m] < 0 ? static_cast<int>(m) : others[m];
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

  // How deep a point lies: below the planes that touch the skin at the points nearest to its samples. None: nowhere.
  double depth(const BodyGrid& grid, const Vector3d& point) const {
    double sum = 0, weights = 0;
    for (std::size_t k = 0; k < 8; ++k) {
      if (sample[k] < 0) continue;
      const Vector3d& skin = grid.skin[static_cast<std::size_t>(sample[k])].position;
      const Vector3d inwards = grid.points.row(sample[k]).transpose() - skin;
      const Vector3d from = (is_mirrored[k] ? Vector3d(-point.x(), point.y(), point.z()) : point) - skin;
      sum += weight[k] * from.dot(inwards) / std::max(inwards.norm(), 1e-12);
      weights += weight[k];
    }
    return weights > 0 ? sum / weights : -1;
  }
  double read(const Eigen::VectorXd& values) const {
    double sum = 0, weights = 0;
    for (std::size_t k = 0; k < 8; ++k) {
      if (sample[k] < 0) continue;
      sum += weight[k] * values[sample[k]];
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

// From the end of a belly along the path to the bone.
double length_beyond(const Positions& path, double belly_end, bool is_origin, Vector3d& end) {
  const double at = belly_end * static_cast<double>(path.rows() - 1);
  const auto row = std::clamp<Index>(static_cast<Index>(at), 0, path.rows() - 2);
  end = path.row(row) + (at - static_cast<double>(row)) * (path.row(row + 1) - path.row(row));
  double length = (path.row(is_origin ? row : row + 1).transpose() - end).norm();
  for (Index k = is_origin ? 0 : row + 1; k < (is_origin ? row : path.rows() - 1); ++k)
    length += (path.row(k + 1) - path.row(k)).norm();
  return length;
}

std::vector<AnatomyField::Tendon> tendons_of(const AnatomyField::Half& half, bool is_other_side) {
  constexpr double kShortest = 0.5;  // of a cell: a belly that reaches its bone is held there, not rigidly
  const Eigen::Affine3d side(Eigen::Scaling(is_other_side ? -1.0 : 1.0, 1.0, 1.0));
  const Eigen::Affine3d to_rest = half.body.from_rest.inverse() * side;
  std::vector<AnatomyField::Tendon> tendons;
  for (const Division::OfMuscle& of : half.division.muscles) {
    const double belly = (of.belly_to - of.belly_from) * path_length(of.path);
    if (!(belly > 0)) continue;
    for (const int end : {0, 1}) {
      if (of.end_joint[end] < 0) continue;
      Vector3d belly_end;
      const double length = length_beyond(of.path, end == 0 ? of.belly_from : of.belly_to, end == 0, belly_end);
      const auto joint = static_cast<std::size_t>(of.end_joint[end]), muscle = static_cast<std::size_t>(of.muscle);
      tendons.push_back({is_other_side ? half.muscle[muscle] : of.muscle,
                         is_other_side ? half.joint[joint] : of.end_joint[end], to_rest * belly_end,
                         to_rest * of.foot[end], std::max(length, kShortest * half.grid.cell),
                         kMuscleStress * of.volume / belly});
    }
  }
  return tendons;
}

// A joint without a counterpart stands for itself.
std::vector<int> other_joints(const Character& character) {
  std::vector<int> others = mirrored_joints(character);
  for (std::size_t j = 0; j < others.size(); ++j) others[j] = others[j] < 0 ? static_cast<int>(j) : others[j];
  return others;
}

}  // namespace

AnatomyField::AnatomyField(const Character& character, const std::vector<Muscle>& muscles,
                           const AnatomyOptions& options) {
  check_options(options);
  require_fit(character, muscles);
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
    half.joint = other_joints(character);
    half.muscle = other_muscles(half.body, muscles);
    halves_.push_back(std::move(half));
  }
  for (const Half& half : halves_) {
    for (const bool is_other_side : {false, true}) {
      if (is_other_side && !is_own_mirror()) continue;
      const std::vector<Tendon> more = tendons_of(half, is_other_side);
      tendons_.insert(tendons_.end(), more.begin(), more.end());
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
  if (!point.allFinite()) return {};
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
  if (!point.allFinite()) return Vector3d::Zero();
  const Place place = place_of(point);
  const int s = lean_sample(*place.half, Corners(*place.half, place.point));
  if (s < 0 || tissue_at(point).muscle < 0) return Vector3d::Zero();
  Vector3d fibre = place.half->division.fibre.row(s);
  if (place.is_other_side) fibre.x() = -fibre.x();
  return place.half->body.from_rest.linear().transpose() * fibre;
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
  for (const Tendon& tendon : tendons_) {
    hash.add(static_cast<std::uint64_t>(tendon.muscle));
    hash.add(static_cast<std::uint64_t>(tendon.joint));
    for (int axis = 0; axis < 3; ++axis) hash.add(tendon.belly_end[axis]);
    for (int axis = 0; axis < 3; ++axis) hash.add(tendon.foot[axis]);
    hash.add(tendon.length);
    hash.add(tendon.largest_force);
  }
  return hash.value();
}

}  // namespace bodyopt
