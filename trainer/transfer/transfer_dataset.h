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
