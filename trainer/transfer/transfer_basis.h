// A trained basis, carried to another character.
#pragma once

#include <string>
#include <vector>

#include "trainer/transfer/transfer_pair.h"

namespace bodyopt {

// The source's coefficients from the target's own joints, strains and controls, on its own Direct Delta Mush. In every
// pose it is the transfer of what the source is off its own in the pose that matches, less the same at the target's
// rest. Shows progress. `notes`: gets what the user should know.
Basis transfer_basis(const TransferPair& pair, const TransferOptions& options, std::vector<std::string>& notes);

}  // namespace bodyopt
