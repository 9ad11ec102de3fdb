// The modifiers of a dataset's curation, carried with it to another character.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "assets/character.h"
#include "dataset/dataset.h"
#include "trainer/transfer/transfer_pair.h"

namespace bodyopt {

// The source's stack for the carried takes, which have the same names and frames. Joints get the target's names;
// lengths
// ("..._mm") change by the target's size; sculpted offsets are carried as shapes are, into files under `out`. What
// chooses by joints that the target does not have, and "blend", whose cache is of the source, stay in the stack,
// disabled, with a note. Throws Error(file), and Error(mismatch) for offsets of another mesh.
std::vector<Modifier> carried_modifiers(const Dataset& dataset, const Character& source_character,
                                        const TransferPair& pair, const std::filesystem::path& out,
                                        std::vector<std::string>& notes);

// Its named selections, with the target's joints.
std::vector<NamedSelection> carried_selections(const Dataset& dataset, const TransferPair& pair);

}  // namespace bodyopt
