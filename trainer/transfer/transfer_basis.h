// A trained basis, carried to another character.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "assets/clip.h"
#include "dataset/dataset.h"
#include "runtime/basis/basis.h"
#include "trainer/transfer/transfer_pair.h"

namespace bodyopt {

// The source's coefficients from the target's own joints, strains and controls, on its own Direct Delta Mush. In every
// pose it is the transfer of what the source is off its own in the pose that matches, less the same at the target's
// rest. Shows progress. `notes`: gets what the user should know.
Basis transfer_basis(const TransferPair& pair, const TransferOptions& options, std::vector<std::string>& notes);

// What is known of a motion on a body that something was carried to: for the report and the viewport.

// What a skin encloses, over what the mesh does at rest. `output`: O x 3, output vertex order, metres. Of an open skin
// a measure that changes as it is carried about, too: compare with care.
double relative_volume(const MeshTable& mesh, std::span<const float> output);

// The frames that would teach a body most, as `simulate --frames` takes them, by what each is expected to be wrong by,
// mm RMS (0: not known); at most twenty, spread over the motion. Empty: nothing is known.
std::string frames_to_simulate(std::span<const int> frames, const std::vector<double>& expected_mm);

// The same of a clip of the body's own, by what the basis knows of its error. Throws as ErrorExpectation, but for a
// basis that knows nothing: it says so by an empty text.
std::string frames_to_simulate(const Basis& basis, const Clip& clip);

// A dataset, carried to another character.

struct TransferTarget {
  Character character;
  std::filesystem::path file;
  double unit = 0;  // as read_character
};

struct TransferredDataset {
  std::size_t takes = 0, frames = 0;
  std::vector<std::string> notes;
};

// Throws Error(mismatch) where the dataset in `out` has a take by the name of one of these that no transfer wrote.
void require_no_own_takes(const Dataset& dataset, const std::filesystem::path& out);

// Into the folder `out`, which is made: clips for the target's skeleton (.glb), shapes (PC2), muscles, controls,
// painted regions, materials, held-out frames, which frames had not converged, and the modifiers of its curation;
// dataset.json last. Every shape is
// un-posed by the source's Direct Delta Mush, carried, and posed by the target's; frames are streamed, a batch at a
// time. Takes that an earlier transfer wrote are replaced, and what refined them is switched off, and said. Shows
// progress. Throws Error(mismatch) where the source's files do not belong together or `out` has a dataset
// of another character or a take of its own by one of the names, Error(file), Error(interrupted).
TransferredDataset transfer_dataset(const Dataset& dataset, const Character& source_character, const TransferPair& pair,
                                    const TransferTarget& target, const std::filesystem::path& out);

}  // namespace bodyopt
