// A trained basis, carried to another character.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "assets/clips/clip.h"
#include "dataset/dataset.h"
#include "runtime/basis/basis.h"
#include "trainer/transfer/transfer_pair.h"

namespace bodyopt::trainer {

// Gives the target's own joints, strains and controls the source's coefficients, on its own Direct Delta Mush. A pose
// then adds the transfer of what it adds to the source in the matching pose, less that at the target's rest. Shows
// progress. `notes`: gets what the user should know.
Basis transfer_basis(const TransferPair& pair, const TransferOptions& options, std::vector<std::string>& notes);

// Estimates of a motion on a body that something was carried to, for the report and the viewport.

// The volume that a skin encloses, over that of the mesh at rest. `output`: O x 3, output vertex order, metres. For an
// open skin it also changes as the skin is carried about: compare with care.
double relative_volume(const MeshTable& mesh, std::span<const float> output);

// The frames that would teach a body most, as `simulate --frames` takes them: at most twenty, spread over the motion.
// `expected_mm`: the error expected of each frame, mm RMS (0: not known). Empty: nothing is known.
std::string frames_to_simulate(std::span<const int> frames, const std::vector<double>& expected_mm);

// Does so for a clip of the body's own, by what the basis knows of its error. Throws as ErrorExpectation, but for a
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

// Writes the folder `out`, which is made: clips for the target's skeleton (.glb), shapes (PC2), muscles, controls,
// painted regions, materials. Held-out frames, frames that had not converged, and the modifiers of its curation are
// named there, too; dataset.json comes last. Every shape is un-posed by the source's Direct Delta Mush, carried, and
// posed by the target's; frames are streamed, a batch at a time. Takes that an earlier transfer wrote are replaced, and
// what refined them is switched off, and said. Shows progress. Throws Error(mismatch) where the source's files do not
// belong together, or `out` has another character's dataset or an own take of one of the names. Throws Error(file),
// Error(interrupted).
TransferredDataset transfer_dataset(const Dataset& dataset, const Character& source_character, const TransferPair& pair,
                                    const TransferTarget& target, const std::filesystem::path& out);

}  // namespace bodyopt::trainer
