// Breathing made of a character's anatomy, without data (Gray's Anatomy; De Troyer, Kirkwood, Wilson 2005). The ribs
// turn about their necks beside the spine. Upper ribs turn about a transverse axis (pump handle: the breastbone goes
// forward and up). Lower ribs turn about an axis from back to front (bucket handle: the flanks go out and up). The
// diaphragm's descent pushes the belly's wall out. A weight of 1 of either component adds a litre to what the skin
// encloses. Chest and belly together gain the air breathed (Konno and Mead 1967), so that what lies below the diaphragm
// keeps its volume.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "base/json_file.h"
#include "dataset/dataset.h"
#include "geometry/mend_surface.h"
#include "geometry/mesh.h"
#include "geometry/surface_distance.h"
#include "runtime/core/error.h"
#include "runtime/core/text.h"
#include "runtime/host/rig.h"
#include "runtime/modifiers/breath_shapes.h"
#include "trainer/curate/shape_stack.h"
#include "trainer/modifiers/bake_modifier.h"
#include "trainer/modifiers/joint_holds.h"
#include "trainer/modifiers/measure_modifiers.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::trainer {
namespace {

constexpr double kManTorso = 0.566;     // metres, hips' joint to neck's of a body 1.75 m tall
constexpr double kShoulderTurn = 0.06;  // radians that the clavicles rise per litre of the chest
constexpr double kLitre = 1e-3;         // cubic metres
constexpr double kDeepBelly = 0.78;     // litres of a man's deepest breath that push the belly's wall (drive_breathing)
constexpr double kMostBelly = 0.0385;   // metres that the wall of a man's belly comes forward in it
constexpr std::size_t kSlices = 24;

// A smooth hump of heights: 1 in the middle, 0 from the ends on.
double hump(double height, double low, double middle, double high) {
  if (!(height > low && height < high)) return 0;
  const double x = height < middle ? (height - low) / (middle - low) : (high - height) / (high - middle);
  return x * x * (3 - 2 * x);
}

// How far the trunk reaches at each height.
class TorsoSlices {
 public:
  TorsoSlices(const Positions& rest, const Torso& torso) : torso_(torso) {
    back_.fill(1e9);
    front_.fill(-1e9);
    half_.fill(0);
    for (Eigen::Index v = 0; v < rest.rows(); ++v) {
      if (torso.share[v] < 0.7) continue;
      const Eigen::Vector3d p = rest.row(v).transpose();
      const double height = torso.height(p) * kSlices;
      if (!(height >= 0 && height < kSlices)) continue;
      const auto s = static_cast<std::size_t>(height);
      back_[s] = std::min(back_[s], forward(p));
      front_[s] = std::max(front_[s], forward(p));
      half_[s] = std::max(half_[s], std::abs(sideways(p)));
    }
    fill_gaps();
  }

  double forward(const Eigen::Vector3d& p) const { return (p - torso_.hips).dot(torso_.front); }
  double sideways(const Eigen::Vector3d& p) const { return (p - torso_.hips).dot(torso_.left); }

  // 0 at the necks of the ribs, 1 at the front.
  double depth(const Eigen::Vector3d& p) const {
    const double back = at(back_, p), front = at(front_, p), necks = back + 0.25 * (front - back);
    return std::clamp((forward(p) - necks) / (front - necks), 0.0, 1.0);
  }
  // -1 to 1 from the right flank to the left.
  double side(const Eigen::Vector3d& p) const { return std::clamp(sideways(p) / at(half_, p), -1.0, 1.0); }

 private:
  using Slices = std::array<double, kSlices>;

  // Linear between the slices' middles.
  double at(const Slices& values, const Eigen::Vector3d& p) const {
    const double x = std::clamp(torso_.height(p) * kSlices - 0.5, 0.0, kSlices - 1.001);
    const auto s = static_cast<std::size_t>(x);
    return std::lerp(values[s], values[s + 1], x - std::floor(x));
  }

  // A slice without vertices is as the one below it, or the first that has some.
  void fill_gaps() {
    const auto known = [&](std::size_t s) { return front_[s] > back_[s] && half_[s] > 0; };
    std::size_t last = 0;
    while (last < kSlices && !known(last)) ++last;
    for (std::size_t s = 0; s < kSlices && last < kSlices; ++s) {
      if (known(s)) last = s;
      back_[s] = back_[last];
      front_[s] = front_[last];
      half_[s] = half_[last];
    }
  }

  const Torso& torso_;
  Slices back_, front_, half_;
};

// The motion of one vertex, in any unit.
Eigen::Vector3d chest_motion(const Torso& torso, const TorsoSlices& slices, const Eigen::Vector3d& p) {
  const double height = torso.height(p), depth = slices.depth(p), side = slices.side(p);
  const double pump = hump(height, 0.44, 0.60, 0.92), bucket = hump(height, 0.31, 0.51, 0.71);
  return pump * depth * (torso.front + 0.45 * torso.up) +
         bucket * (side * torso.left + std::abs(side) * 0.3 * torso.up + 0.5 * depth * torso.front);
}

Eigen::Vector3d belly_motion(const Torso& torso, const TorsoSlices& slices, const Eigen::Vector3d& p) {
  const double window = hump(torso.height(p), 0.04, 0.24, 0.44);
  return window * slices.depth(p) * std::cos(0.5 * std::numbers::pi * slices.side(p)) * torso.front;
}

// The motion of the trunk's skin, smoothed, at the scale that adds a litre.
template <typename Motion>
Positions litre_of(const BakeInput& input, const Positions& rest, const Torso& torso, const SkinSmoother& smoother,
                   const Motion& motion) {
  const Triangles triangles = rows_of(input.basis.mesh.triangles);
  Positions field(rest.rows(), 3);
  for (Eigen::Index v = 0; v < rest.rows(); ++v) {
    field.row(v) = torso.share[v] * motion(rest.row(v).transpose()).transpose();
  }
  field = smoother(field);
  const double step = 0.01 * torso.length;  // of the field, whose size is about 1
  const double volume = (enclosed_volume(rest + step * field, triangles) - enclosed_volume(rest, triangles)) / step;
  if (!(volume > 1e-3 * torso.length * torso.length)) {
    throw Error(ErrorKind::mismatch, input.place,
                ": the skin around the trunk does not gain volume when it is pushed "
                "out: is the body open there, or inside out?");
  }
  return field * (kLitre / volume);
}

// Litres of this body for one of a man's: by the cube of the trunk's length, but less for a slender belly.
double litres_of(const Torso& torso, const Positions& belly) {
  const double size = torso.length / kManTorso, wall = kDeepBelly * belly.rowwise().norm().maxCoeff();
  return std::min(std::pow(size, 3), kMostBelly * size / wall);
}

void add_shoulders(const Basis& basis, const Torso& torso, double litres, BakedModifier& baked) {
  const std::vector<Quat> bind = bind_rotations(basis.skeleton);
  for (std::size_t side = 0; side < 2; ++side) {
    if (torso.clavicles[side] < 0) continue;
    const auto joint = static_cast<std::uint32_t>(torso.clavicles[side]);
    const int parent = basis.skeleton.joints[joint].parent;
    Vec3 axis{torso.front.x(), torso.front.y(), torso.front.z()};
    if (parent >= 0) axis = rotate(conjugate(bind[static_cast<std::size_t>(parent)]), axis);
    const double turn = (side == 0 ? 1 : -1) * kShoulderTurn / litres;
    baked.turns.push_back({joint, 0, static_cast<float>(turn * axis[0]), static_cast<float>(turn * axis[1]),
                           static_cast<float>(turn * axis[2])});
  }
}

// Breathing learnt of a take of a dataset: what its shapes have beyond the skin that the basis gives in the same poses.

struct LearntBreath {
  std::vector<Positions> shapes;  // kBreathShapes, V x 3: beyond the skin that is breathed out
  double litres = 0;              // between the emptiest frame and the fullest
};

constexpr double kLeastGain = 1e-5;  // of the volume: less is noise
constexpr double kLeastShare = 0.5;  // that each shape must have of all frames together

Eigen::VectorXd volumes_of(const Positions& rest, const Triangles& triangles, const std::vector<Positions>& offsets) {
  Eigen::VectorXd volumes(static_cast<Eigen::Index>(offsets.size()));
  for (std::size_t n = 0; n < offsets.size(); ++n) {
    volumes[static_cast<Eigen::Index>(n)] = enclosed_volume(rest + offsets[n], triangles);
  }
  return volumes;
}

// N x (1 + kBreathShapes): 1, for the skin that is breathed out, and how much of each shape a frame shows.
Eigen::MatrixXd shares_of(const Eigen::VectorXd& filled) {
  const Eigen::Index frames = filled.size();
  Eigen::MatrixXd shares(frames, 1 + static_cast<Eigen::Index>(kBreathShapes));
  for (Eigen::Index n = 0; n < frames; ++n) {
    const bool comes_in = filled[std::min(n + 1, frames - 1)] > filled[std::max<Eigen::Index>(n - 1, 0)];
    const std::array<double, kBreathShapes> own = breath_shapes(filled[n], comes_in);
    shares(n, 0) = 1;
    for (std::size_t k = 0; k < kBreathShapes; ++k) shares(n, static_cast<Eigen::Index>(k) + 1) = own[k];
  }
  return shares;
}

// offsets: of consecutive frames, V x 3 each, un-posed, what their skin has beyond that of the same pose. The volume
// that the skin encloses says how far a frame is filled; the frames beside it, whether the breath comes in. The shapes
// are those that fit all frames best. Throws Error(mismatch), naming `place`, where the skin gains no volume, or there
// is no whole breath.
LearntBreath learn_breath(const Positions& rest, const Triangles& triangles, const std::vector<Positions>& offsets,
                          const std::string& place) {
  const auto refuse = [&](const std::string& what) {
    throw Error(ErrorKind::mismatch, place, ": the take ", what,
                ": expected frames of a whole breath, in and out, of a skin that is closed");
  };
  if (offsets.empty()) refuse("has no frames");
  const Eigen::VectorXd volumes = volumes_of(rest, triangles, offsets);
  const double empty = volumes.minCoeff(), gained = volumes.maxCoeff() - empty;
  if (!(gained > kLeastGain * std::abs(empty))) refuse("does not breathe: its skin gains no volume");
  const Eigen::MatrixXd shares = shares_of((volumes.array() - empty) / gained);
  if (!(shares.colwise().sum().minCoeff() > kLeastShare)) refuse("shows a part of a breath only");
  const Eigen::Index vertices = rest.rows();
  Eigen::MatrixXd frames(shares.rows(), 3 * vertices);
  for (std::size_t n = 0; n < offsets.size(); ++n) {
    frames.row(static_cast<Eigen::Index>(n)) = offsets[n].reshaped<Eigen::RowMajor>().transpose();
  }
  const Eigen::MatrixXd fitted = shares.colPivHouseholderQr().solve(frames);
  LearntBreath breath;
  breath.litres = 1e3 * gained;
  for (Eigen::Index k = 1; k < fitted.rows(); ++k) {
    breath.shapes.push_back(fitted.row(k).reshaped<Eigen::RowMajor>(vertices, 3));
  }
  return breath;
}

constexpr double kUsualDepth = 0.6;  // of the control: at it a breath is as deep as the take's

// The take's frames of the database, in the order of the take's cache.
std::vector<std::size_t> frames_of(const BakeInput& input, const PoseDatabase& database) {
  const std::string take = input.parameters.name("take");
  std::vector<std::size_t> frames;
  for (std::size_t n = 0; n < database.frames.size(); ++n) {
    if (database.take_of(n) == take) frames.push_back(n);
  }
  if (frames.empty()) input.parameters.refuse("learns of the take '", take, "', of which the dataset has no shapes");
  return frames;
}

}  // namespace

// numbers: litres of this body for one of a man's.
BakedModifier bake_breathing(const BakeInput& input) {
  if (input.parameters.has("dataset") || input.parameters.has("take")) return bake_learnt_breathing(input);
  const Torso torso = find_torso(input.basis, input.place);
  const Positions rest = rows_of(input.basis.mesh.rest);
  const TorsoSlices slices(rest, torso);
  const SkinSmoother smoother(rest, rows_of(input.basis.mesh.triangles), 0.03 * torso.length);
  BakedModifier baked;
  baked.components.push_back(
      litre_of(input, rest, torso, smoother, [&](const Eigen::Vector3d& p) { return chest_motion(torso, slices, p); }));
  baked.components.push_back(
      litre_of(input, rest, torso, smoother, [&](const Eigen::Vector3d& p) { return belly_motion(torso, slices, p); }));
  const double litres = litres_of(torso, baked.components.back());
  add_shoulders(input.basis, torso, litres, baked);
  baked.numbers = {static_cast<float>(litres)};
  return baked;
}

// numbers: parts of the take's breath for a depth of one.
BakedModifier bake_learnt_breathing(const BakeInput& input) {
  const ShapeStack stack(read_pose_database(read_dataset(input.folder / input.parameters.name("dataset"))));
  const PoseDatabase& database = stack.database();
  const std::vector<std::size_t> frames = frames_of(input, database);
  EvaluatedSkin skin(without_modifiers(input.basis));
  std::vector<Positions> offsets;
  for (const std::size_t n : frames) {
    Pose pose = database.frames[n].pose;
    pose.controls.clear();
    const Positions shape =
        modifier_shape(input, output_from_welded(database.character, stack.shape(n)), "the dataset's character");
    offsets.push_back(unpose_ddm(input.basis, pose, shape) - unpose_ddm(input.basis, pose, skin({&pose, 1})[0]));
  }
  const LearntBreath breath =
      learn_breath(rows_of(input.basis.mesh.rest), rows_of(input.basis.mesh.triangles), offsets, input.place);
  input.notes.push_back(input.place + " is learnt of " +
                        formatted("%zu frames: %.2f litres a breath", offsets.size(), breath.litres));
  BakedModifier baked;
  baked.components = breath.shapes;
  baked.numbers = {static_cast<float>(1 / kUsualDepth)};
  return baked;
}

}  // namespace bodyopt::trainer
