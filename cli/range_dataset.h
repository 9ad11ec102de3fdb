// Training data of `train CHARACTER`: drafts of a range of motion that is made for the character, and of its clips.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/arguments/common.h"

namespace bodyopt::cli {

struct RangeDatasetArguments {
  std::string folder;              // of the dataset; empty: beside the basis
  std::vector<std::string> clips;  // none: the character's own
  std::string limits, muscles;
  double minutes = kMinutes;  // of simulation, by the clock
  bool no_range = false;
  ClipOptions clip;

  void add(CLI::App& verb);
  bool any() const;  // is any of them given?

  static constexpr double kMinutes = 10;
};

// Makes, or goes on with, a dataset in the folder, and returns the folder. It holds range_of_motion.glb, a take of
// drafts for it and for every clip, and limits.json unless given, from clips and rules. Clips take half of the minutes
// at most (all of them without a range of motion), by the seconds that the first drafts took. The range of motion takes
// the rest, a hundred frames at least. Files in the folder are kept: limits may be edited, drafts are not made again.
// Throws as the verbs rig, rom and simulate.
std::filesystem::path make_range_dataset(const std::string& character, double unit,
                                         const RangeDatasetArguments& arguments);

}  // namespace bodyopt::cli
