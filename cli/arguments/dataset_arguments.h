// Shared by the verbs that add takes to a dataset: its dataset.json, and a take's name and contents.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cli/arguments/common.h"
#include "dataset/dataset.h"
#include "trainer/anatomy/field.h"
#include "trainer/simulate/simulate.h"

namespace bodyopt::cli {

// --clip CLIP and what goes with it, [--name TAKE] [--heldout R|all]
struct TakeArguments {
  ClipArguments clip;
  std::string name, heldout;
  void add(CLI::App& verb);
  // The name that --name gives, or else the clip's.
  std::string take_name() const;
  // A take of these frames in a dataset of that folder, without shapes. Throws Error(usage) where --heldout names a
  // frame that is not among them.
  DatasetTake take(const std::vector<int>& frames, const std::filesystem::path& folder) const;
};

// A file's name relative to a folder; an empty one stays empty.
std::string relative_to(const std::filesystem::path& folder, const std::string& path);

// Warns of frames that the take holds out although `asked` did not ask for it.
void say_heldout(const DatasetTake& take, const DatasetTake& asked);

// [--body-fat X] [--kind K] [--corrections FILE]
struct FieldArguments {
  double body_fat = 0;  // 0: not given
  std::string kind, corrections;
  void add(CLI::App& verb);
  // Throws as read_corrections().
  trainer::AnatomyOptions options(const Skeleton& skeleton) const;
  // Stores them as the dataset keeps them.
  void put_into(Dataset& dataset) const;
};

// Frames of a clip to shapes in a dataset: what `simulate` and `improve` do.

struct SimulationArguments {
  std::string character, muscles, materials;
  std::string out;  // the dataset's folder
  // The way out where another run writes the take: what the verb can do, in words.
  std::string instead = TakeLock::kOtherName;
  double unit = 0;
  FieldArguments anatomy;
  TakeArguments take;
  trainer::SimulateOptions options;
};

// What takes that differ in nothing else are simulated in. Files that change in between change nothing.
struct PreparedBody {
  PreparedBody(Character of, std::vector<Muscle> its_muscles, const trainer::SimulateOptions& options);

  Character character;
  std::vector<Muscle> muscles;
  trainer::QuasiStaticBody body;
};

// Simulates, and adds the take, or its new frames, to the dataset.json of the folder. The first take prepares the body
// that the others share. Throws as simulate(), and Error(mismatch) where the dataset or the take is of something else.
std::vector<FrameStatus> simulate_take(const SimulationArguments& arguments, std::optional<PreparedBody>& prepared);

}  // namespace bodyopt::cli
