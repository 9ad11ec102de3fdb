#include "trainer/train/data/samples.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "assets/controls.h"
#include "assets/shape_reader.h"
#include "dataset/regions_file.h"
#include "runtime/core/error.h"
#include "runtime/core/transform.h"

namespace bodyopt {
namespace {

// Fewer frames cannot be split for cross-validation.
constexpr std::size_t kFewestFrames = 12;

void check_pose(const SampleSet& set, const Sample& sample) {
  const Pose& pose = sample.pose;
  if (pose.controls.size() != set.controls.size()) {
    throw Error(ErrorKind::mismatch, frame_name(set, sample) + " has " + std::to_string(pose.controls.size()) +
                                         " control values for " + std::to_string(set.controls.size()) + " controls");
  }
  for (std::size_t k = 0; k < pose.controls.size(); ++k) {
    if (std::isfinite(pose.controls[k])) continue;
    throw Error(ErrorKind::mismatch,
                frame_name(set, sample) + ": the value of control '" + set.controls[k] + "' is not a finite number");
  }
  for (std::size_t j = 0; j < std::min(pose.joints.size(), set.character.skeleton.size()); ++j) {
    const Affine local = affine_from(pose.joints[j]);
    if (Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(&local.m[0][0]).allFinite()) continue;
    throw Error(ErrorKind::mismatch, frame_name(set, sample) + ": the transform of joint '" +
                                         set.character.skeleton.joints[j].name + "' holds a number that is not finite");
  }
}

void check_take(const DatasetTake& take, const Character& character, const Clip& clip, const ShapeReader& shapes) {
  const std::string where = "take '" + take.name + "', " + take.shapes + ": ";
  if (shapes.point_count() != character.output_count()) {
    throw Error(ErrorKind::mismatch, where + "the cache has " + std::to_string(shapes.point_count()) +
                                         " points, the character has " + std::to_string(character.output_count()) +
                                         " output vertices: it was made from another mesh");
  }
  if (shapes.sample_count() != take.frames.size()) {
    throw Error(ErrorKind::mismatch, where + "the cache has " + std::to_string(shapes.sample_count()) +
                                         " samples, the dataset names " + std::to_string(take.frames.size()) +
                                         " frames: one of the two was made anew without the other");
  }
  for (const int frame : take.frames) {
    if (frame < clip.first_frame || frame > clip.last_frame()) {
      throw Error(ErrorKind::mismatch, "take '" + take.name + "': frame " + std::to_string(frame) +
                                           " is not in the clip " + take.clip + ", which has frames " +
                                           std::to_string(clip.first_frame) + " to " +
                                           std::to_string(clip.last_frame()) + ": first_frame or fps may be wrong");
    }
  }
}

void read_take(const Dataset& dataset, int index, const Clip& clip, const std::shared_ptr<const Character>& character,
               SampleSet& set) {
  const DatasetTake& take = dataset.takes[static_cast<std::size_t>(index)];
  for (const std::string& note : clip.notes) set.notes.push_back("take '" + take.name + "': " + note);
  const auto cache =
      std::make_shared<const ShapeCache>(ShapeCache{ShapeReader(dataset.folder / take.shapes), character});
  check_take(take, set.character, clip, cache->reader);
  const std::set<int> heldout(take.heldout.begin(), take.heldout.end());
  const std::set<int> unconverged = unconverged_frames(dataset, take);
  for (std::uint32_t k = 0; k < cache->reader.sample_count(); ++k) {
    const int frame = take.frames[k];
    if (unconverged.count(frame) > 0) {
      ++set.unconverged;
      continue;
    }
    Sample sample;
    sample.take = index;
    sample.frame = frame;
    sample.pose = clip.poses[static_cast<std::size_t>(frame - clip.first_frame)];
    sample.shape = {cache, k};
    (heldout.count(frame) > 0 ? set.heldout : set.train).push_back(std::move(sample));
  }
}

}  // namespace

SampleSet read_samples(const Dataset& dataset) {
  SampleSet set;
  set.character = read_character(dataset.folder / dataset.character, dataset.unit);
  set.notes = set.character.notes;
  if (!dataset.muscles.empty()) set.muscles = read_muscles(dataset.folder / dataset.muscles, set.character.skeleton);
  set.regions = read_regions(dataset, set.character);
  // Every pose gets a value for every control of any take.
  std::vector<Clip> clips;
  for (const DatasetTake& take : dataset.takes) {
    clips.push_back(read_clip(dataset, take, set.character.skeleton));
    for (const std::string& name : clips.back().controls) {
      if (std::find(set.controls.begin(), set.controls.end(), name) == set.controls.end()) set.controls.push_back(name);
    }
  }
  const auto character = std::make_shared<const Character>(set.character);
  for (std::size_t k = 0; k < clips.size(); ++k) {
    set.takes.push_back(dataset.takes[k].name);
    arrange_controls(set.controls, clips[k]);
    read_take(dataset, static_cast<int>(k), clips[k], character, set);
  }
  return set;
}

void check_samples(const SampleSet& set) {
  if (set.train.size() < kFewestFrames) {
    throw Error(ErrorKind::mismatch, "training needs " + std::to_string(kFewestFrames) +
                                         " frames at least, the dataset leaves " + std::to_string(set.train.size()) +
                                         " (held out: " + std::to_string(set.heldout.size()) +
                                         ", unconverged: " + std::to_string(set.unconverged) + ")");
  }
  for (const std::vector<Sample>* samples : {&set.train, &set.heldout}) {
    for (const Sample& sample : *samples) check_pose(set, sample);
  }
}

std::string frame_name(const SampleSet& set, const Sample& sample) {
  return "frame " + std::to_string(sample.frame) + " of take '" + set.takes[static_cast<std::size_t>(sample.take)] +
         "'";
}

}  // namespace bodyopt
