#include "trainer/train/data/samples.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "assets/caches/shape_reader.h"
#include "runtime/core/error.h"
#include "runtime/core/transform.h"
#include "runtime/core/transformed.h"
#include "trainer/curate/shape_stack.h"

namespace bodyopt::trainer {
namespace {

void check_pose(const SampleSet& set, const Sample& sample) {
  const Pose& pose = sample.pose;
  if (pose.controls.size() != set.controls.size()) {
    throw Error(ErrorKind::mismatch, frame_name(set, sample) + " has " + std::to_string(pose.controls.size()) +
                                         " control values for " + std::to_string(set.controls.size()) + " controls");
  }
  for (std::size_t k = 0; k < pose.controls.size(); ++k) {
    if (std::isfinite(pose.controls[k])) continue;
    throw Error(ErrorKind::mismatch,
                frame_name(set, sample) + ": the value of control '" + set.controls[k] + "' is not a finite number",
                ErrorCause::damaged);
  }
  for (std::size_t j = 0; j < std::min(pose.joints.size(), set.character.skeleton.size()); ++j) {
    const Affine local = affine_from(pose.joints[j]);
    if (Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(&local.m[0][0]).allFinite()) continue;
    throw Error(ErrorKind::mismatch,
                frame_name(set, sample) + ": the transform of joint '" + set.character.skeleton.joints[j].name +
                    "' holds a number that is not finite",
                ErrorCause::damaged);
  }
}

}  // namespace

SampleSet read_samples(const Dataset& dataset) {
  const auto stack = std::make_shared<const ShapeStack>(read_pose_database(dataset));
  const PoseDatabase& database = stack->database();
  SampleSet set;
  set.character = database.character;
  set.muscles = database.muscles;
  set.takes = database.takes;
  set.controls = database.controls;
  set.regions = database.regions;
  set.unconverged = database.unconverged;
  set.notes = database.notes;
  set.notes.insert(set.notes.end(), stack->notes().begin(), stack->notes().end());
  for (std::size_t n = 0; n < database.frames.size(); ++n) {
    if (stack->is_dropped(n)) continue;
    const DatabaseFrame& frame = database.frames[n];
    (frame.heldout ? set.heldout : set.train)
        .push_back({frame.take, frame.frame, frame.pose, {stack, n}, stack->weight(n), frame.sample, frame.image_of});
  }
  return set;
}

std::vector<std::size_t> training_origins(const SampleSet& set) {
  std::map<std::pair<int, std::size_t>, std::size_t> at;  // by take and place
  for (std::size_t n = 0; n < set.train.size(); ++n) at[{set.train[n].take, set.train[n].place}] = n;
  std::vector<std::size_t> origins;
  for (std::size_t n = 0; n < set.train.size(); ++n) {
    const auto origin = at.find({set.train[n].image_of, set.train[n].place});
    origins.push_back(origin == at.end() ? n : origin->second);
  }
  return origins;
}

std::vector<const Pose*> poses_of(const std::vector<Sample>& samples) {
  return transformed(samples, [](const Sample& sample) { return &sample.pose; });
}

std::vector<Pose> training_poses(const SampleSet& set) { return transformed(set.train, &Sample::pose); }

void check_samples(const SampleSet& set) {
  if (set.train.size() < kFewestFrames) {
    throw Error(ErrorKind::mismatch,
                "training needs " + std::to_string(kFewestFrames) + " frames at least, the dataset leaves " +
                    std::to_string(set.train.size()) + " (held out: " + std::to_string(set.heldout.size()) +
                    ", unconverged: " + std::to_string(set.unconverged) + ")",
                ErrorCause::too_few_frames);
  }
  for (const std::vector<Sample>* samples : {&set.train, &set.heldout}) {
    for (const Sample& sample : *samples) check_pose(set, sample);
  }
}

std::string frame_name(const SampleSet& set, const Sample& sample) {
  return "frame " + std::to_string(sample.frame) + " of take '" + set.take_of(sample) + "'";
}

SampleShape SampleShape::at(std::shared_ptr<const VertexRows> rows) const {
  SampleShape result = *this;
  result.rows_ = std::move(rows);
  return result;
}

Positions SampleShape::read() const {
  if (!rows_) return whole();
  const Positions all = whole();
  return all(*rows_, Eigen::all);
}

Positions SampleShape::whole() const {
  if (stack_) return stack_->shape(frame_);
  if (cache_) return welded_from_output(*cache_->character, cache_->reader->sample(sample_).data());
  return positions_ ? *positions_ : Positions();
}

}  // namespace bodyopt::trainer
