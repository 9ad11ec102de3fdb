#include "trainer/curate/pose_database.h"

#include <algorithm>
#include <set>

#include "assets/clips/controls.h"
#include "base/wording.h"
#include "dataset/regions_file.h"
#include "runtime/core/error.h"

namespace bodyopt::trainer {
namespace {

void check_take(const DatasetTake& take, const Character& character, const Clip& clip, const ShapeReader& shapes) {
  const std::string where = "take '" + take.name + "', " + take.shapes + ": ";
  if (shapes.point_count() != character.output_count()) {
    throw Error(ErrorKind::mismatch, where, "the cache has ", shapes.point_count(), " points, the character has ",
                character.output_count(), " output vertices: it was made from another mesh");
  }
  if (shapes.sample_count() != take.frames.size()) {
    throw Error(ErrorKind::mismatch, where, "the cache has ", shapes.sample_count(), " samples, the dataset names ",
                take.frames.size(), " frames: one of the two was made anew without the other");
  }
  for (const int frame : take.frames) {
    if (frame < clip.first_frame || frame > clip.last_frame()) {
      throw Error(ErrorKind::mismatch, "take '", take.name, "': frame ", frame, " is not in the clip ", take.clip,
                  ", which has frames ", clip.first_frame, " to ", clip.last_frame(),
                  ": first_frame or fps may be wrong");
    }
  }
}

void read_take(int index, const Clip& clip, PoseDatabase& database) {
  const DatasetTake& take = database.dataset.takes[static_cast<std::size_t>(index)];
  for (const std::string& note : clip.notes) database.notes.push_back("take '" + take.name + "': " + note);
  const auto reader = std::make_shared<const ShapeReader>(database.dataset.folder / take.shapes);
  check_take(take, database.character, clip, *reader);
  const std::set<int> heldout(take.heldout.begin(), take.heldout.end());
  const std::set<int> unconverged = unconverged_frames(database.dataset, take);
  for (std::uint32_t k = 0; k < reader->sample_count(); ++k) {
    const int frame = take.frames[k];
    if (unconverged.contains(frame)) {
      ++database.unconverged;
      continue;
    }
    database.frames.push_back(
        {index, k, frame, clip.poses[static_cast<std::size_t>(frame - clip.first_frame)], heldout.contains(frame)});
  }
  database.takes.push_back(take.name);
  database.readers.push_back(reader);
}

}  // namespace

Positions PoseDatabase::raw_shape(std::size_t frame) const {
  const DatabaseFrame& of = frames[frame];
  return welded_from_output(character, readers[static_cast<std::size_t>(of.take)]->sample(of.sample).data());
}

int PoseDatabase::take_named(const std::string& name, const std::string& place) const {
  const auto found = std::ranges::find(takes, name);
  if (found != takes.end()) return static_cast<int>(found - takes.begin());
  throw Error(ErrorKind::mismatch, place, ": the dataset has no take '", name, "'; it has ", list_names(takes));
}

std::size_t PoseDatabase::find(const std::string& take, int frame, const std::string& place) const {
  const int number = take_named(take, place);
  std::vector<int> below, above;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    if (frames[n].take != number) continue;
    if (frames[n].frame == frame) return n;
    (frames[n].frame < frame ? below : above).push_back(frames[n].frame);
  }
  std::string nearest;
  if (!below.empty()) nearest = std::to_string(*std::ranges::max_element(below));
  if (!above.empty()) {
    nearest += (below.empty() ? "" : " and ") + std::to_string(*std::ranges::min_element(above));
  }
  throw Error(ErrorKind::mismatch, place, ": take '", take, "' has no solved frame ", frame,
              (nearest.empty() ? "" : "; nearest to it: " + nearest));
}

PoseDatabase read_pose_database(const Dataset& dataset) {
  PoseDatabase database;
  database.dataset = dataset;
  database.character = read_character(dataset.folder / dataset.character, dataset.unit);
  database.notes = database.character.notes;
  const Skeleton& skeleton = database.character.skeleton;
  if (!dataset.muscles.empty()) database.muscles = read_muscles(dataset.folder / dataset.muscles, skeleton);
  database.regions = read_regions(dataset, database.character);
  // Every pose gets a value for every control of any take.
  std::vector<Clip> clips;
  for (const DatasetTake& take : dataset.takes) {
    clips.push_back(read_clip(dataset, take, skeleton));
    for (const std::string& name : clips.back().controls) {
      const bool known = std::ranges::find(database.controls, name) != database.controls.end();
      if (!known) database.controls.push_back(name);
    }
  }
  for (std::size_t k = 0; k < clips.size(); ++k) {
    arrange_controls(database.controls, clips[k]);
    read_take(static_cast<int>(k), clips[k], database);
  }
  return database;
}

}  // namespace bodyopt::trainer
