// What `train CHARACTER` learns from: drafts of a range of motion that is made for the character, and of its clips.
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

// Makes, or goes on with, a dataset in the folder, and returns the folder. In it are limits.json (unless given: what
// clips show, and rules), range_of_motion.glb, and a take of drafts for it and for every clip. Clips take half of the
// minutes at most (all of them without a range of motion), the range of motion what is left, by the seconds that the
// first drafts took; it gets a hundred frames at least. What is in the folder already is kept: limits may be edited,
// drafts are not made again. Throws as the verbs rig, rom and simulate.
std::filesystem::path make_range_dataset(const std::string& character, double unit,
                                         const RangeDatasetArguments& arguments);

}  // namespace bodyopt::cli
