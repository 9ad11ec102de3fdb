// What the verbs that add takes to a dataset share: its dataset.json, and what a take is called and made of.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/arguments/common.h"
#include "dataset/dataset.h"

namespace bodyopt::cli {

// --clip CLIP and what goes with it, [--name TAKE] [--heldout R|all]
struct TakeArguments {
  ClipArguments clip;
  std::string name, heldout;
  void add(CLI::App& verb);
  // As --name says, or as the clip is called.
  std::string take_name() const;
  // A take of these frames in a dataset of that folder, without shapes. Throws Error(usage) where --heldout names a
  // frame that is not among them.
  DatasetTake take(const std::vector<int>& frames, const std::filesystem::path& folder) const;
};

// A file's name relative to a folder; an empty one stays empty.
std::string relative_to(const std::filesystem::path& folder, const std::string& path);

// Warns of frames that the take holds out although `asked` did not ask for it.
void say_heldout(const DatasetTake& take, const DatasetTake& asked);

}  // namespace bodyopt::cli
