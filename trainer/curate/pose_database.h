// The pose database: every solved frame of a dataset, its pose and its raw shape, as it is before any modifier.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "assets/caches/shape_reader.h"
#include "assets/characters/character.h"
#include "assets/characters/muscles.h"
#include "dataset/dataset.h"
#include "geometry/region_weights.h"

namespace bodyopt::trainer {

struct DatabaseFrame {
  int take = 0;
  std::uint32_t sample = 0;  // of the take's cache
  int frame = 0;
  Pose pose;  // a value for every control of any take
  bool heldout = false;
  int image_of = -1;  // the take of the frame whose mirror image this is
};

struct PoseDatabase {
  Dataset dataset;
  Character character;
  std::vector<Muscle> muscles;
  std::vector<RegionWeights> regions;  // painted: as read_regions
  std::vector<std::string> controls;   // of every pose, by name
  std::vector<std::string> takes;      // names, by DatabaseFrame::take
  std::vector<DatabaseFrame> frames;   // by take, in the order of their caches
  int unconverged = 0;                 // frames that are left out
  std::vector<std::string> notes;
  std::vector<std::shared_ptr<const ShapeReader>> readers;  // by take

  const std::string& take_of(std::size_t frame) const { return takes[static_cast<std::size_t>(frames[frame].take)]; }
  // "rom 40".
  std::string name_of(std::size_t frame) const { return take_of(frame) + " " + std::to_string(frames[frame].frame); }
  // V x 3, welded, posed, metres, as the cache has it. On any thread. Throws Error(file) at a damaged sample.
  Positions raw_shape(std::size_t frame) const;
  // Number of a take; throws Error(mismatch), naming `place`, where there is none of the name.
  int take_named(const std::string& name, const std::string& place) const;
  // Index of a frame by its take's name and its number; throws Error(mismatch), naming `place`, where there is none.
  std::size_t find(const std::string& take, int frame, const std::string& place) const;
};

// Shapes stay on disk. Throws Error(mismatch) where caches do not belong to the character or the clips, Error(file).
PoseDatabase read_pose_database(const Dataset& dataset);

}  // namespace bodyopt::trainer
