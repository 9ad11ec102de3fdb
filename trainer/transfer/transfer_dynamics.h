// Jiggle for a body that a basis was carried to.
#pragma once

#include <string>
#include <vector>

#include "trainer/dynamics/build_dynamics.h"
#include "trainer/transfer/transfer_pair.h"

namespace bodyopt {

// Tetrahedra fill one body alone: the dynamics are made anew of the target's, as those of the source were asked for. As
// many tets at most, the same steps; settings with the target's joints in place of the source's and lengths in its
// size; what they left open is chosen for the target. `basis`: what was carried to the target. `muscles`: the source's;
// without them tissue does not tense. `notes`: gets what of the settings has nothing to name on the target, painted
// regions among it, which a basis does not hold. Shows progress; throws as build_dynamics() and asked_options().
Dynamics transfer_dynamics(const TransferPair& pair, const Character& target, const Basis& basis,
                           const Dynamics& source, const std::vector<Muscle>& muscles, std::vector<std::string>& notes);

}  // namespace bodyopt
