// Breathing learnt of a take of a dataset: what its shapes have beyond the skin that the basis gives in the same poses.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "assets/character.h"
#include "assets/json_file.h"
#include "dataset/dataset.h"
#include "geometry/closed_skin.h"
#include "geometry/mesh.h"
#include "geometry/table_rows.h"
#include "runtime/core/error.h"
#include "runtime/modifiers/breath_shapes.h"
#include "trainer/curate/shape_stack.h"
#include "trainer/modifiers/bake_modifier.h"
#include "trainer/modifiers/evaluated_skin.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt {
namespace {

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

// offsets: of consecutive frames, V x 3 each, un-posed, what their skin has beyond that of the same pose. How far a
// frame is filled is told by the volume that the skin encloses, and whether the breath comes in by the frames beside
// it; the shapes are those that fit all frames best. Throws Error(mismatch), naming `place`, where the skin gains no
// volume, or there is no whole breath.
LearntBreath learn_breath(const Positions& rest, const Triangles& triangles, const std::vector<Positions>& offsets,
                          const std::string& place) {
  const auto refuse = [&](const std::string& what) {
    throw Error(ErrorKind::mismatch, place + ": the take " + what +
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

// Of the database, in the order of the take's cache.
std::vector<std::size_t> frames_of(const BakeInput& input, const PoseDatabase& database) {
  const std::string take = input.parameters.name("take");
  std::vector<std::size_t> frames;
  for (std::size_t n = 0; n < database.frames.size(); ++n) {
    if (database.take_of(n) == take) frames.push_back(n);
  }
  if (frames.empty()) input.parameters.refuse("learns of the take '" + take + "', of which the dataset has no shapes");
  return frames;
}

}  // namespace

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
  char text[64];
  std::snprintf(text, sizeof text, "%zu frames: %.2f litres a breath", offsets.size(), breath.litres);
  input.notes.push_back(input.place + " is learnt of " + text);
  BakedModifier baked;
  baked.components = breath.shapes;
  baked.numbers = {static_cast<float>(1 / kUsualDepth)};
  return baked;
}

}  // namespace bodyopt
