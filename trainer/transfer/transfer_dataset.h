// A dataset, carried to another character.
#pragma once

#include <filesystem>

#include "dataset/dataset.h"
#include "trainer/transfer/transfer_pair.h"

namespace bodyopt {

struct TransferTarget {
  Character character;
  std::filesystem::path file;
  double unit = 0;  // as read_character
};

struct TransferredDataset {
  std::size_t takes = 0, frames = 0;
  std::vector<std::string> notes;
};

// Into the folder `out`, which is made: clips for the target's skeleton (.glb), shapes (PC2), muscles, controls,
// painted regions, materials, held-out frames, which frames had not converged, and the modifiers of its curation;
// dataset.json last. Every shape is
// un-posed by the source's Direct Delta Mush, carried, and posed by the target's; frames are streamed, a batch at a
// time. Shows progress. Throws Error(mismatch) where the source's files do not belong together or `out` has a dataset
// of another character, Error(file), Error(interrupted).
TransferredDataset transfer_dataset(const Dataset& dataset, const Character& source_character, const TransferPair& pair,
                                    const TransferTarget& target, const std::filesystem::path& out);

}  // namespace bodyopt
