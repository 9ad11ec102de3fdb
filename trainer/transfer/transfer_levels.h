// Levels of detail of a character, carried to another.
#pragma once

#include <string>
#include <vector>

#include "runtime/basis/levels.h"
#include "trainer/dynamics/build_dynamics.h"
#include "trainer/transfer/transfer_pair.h"

namespace bodyopt::trainer {

// Lays each level's triangles onto the target where the source's skin around their vertices lies on it, with its skin
// weights. What the level learned is carried to that as transfer_basis() does, and it carries the target's full skin.
// Where the finest lies too far off, the levels are the target's own (own_level_skins), no more than the source has.
// Too far is over three times as far as off the source's skin, in its size, as where the source lacks a part. The
// errors reported of the levels are the source's, in the target's size; distances at rest are measured. `levels`: a
// proxy of the pair's source, or one whose first level that is. `target`: of the pair. Shows progress. Empty where the
// target's skin has too few vertices for a level of its own: `notes` say so.
std::vector<Level> transfer_levels(const TransferPair& pair, const Character& target, const std::vector<Level>& levels,
                                   const TransferOptions& options, std::vector<std::string>& notes);

// Throws Error(mismatch) where the levels are no proxy of the source: of another skeleton or number of vertices.
void require_proxy_of(const Basis& source, const std::vector<Level>& levels);

// Makes the target's dynamics as those of the source were asked for, but anew: tetrahedra fill one body alone. It has
// as many tets at most, and the same steps. Settings have the target's joints in place of the source's, and lengths in
// its size; what they left open is chosen for the target. `basis`: what was carried to the target. `muscles`: the
// source's; without them tissue does not tense. `notes`: gets what of the settings has nothing to name on the target,
// painted regions among it, which a basis does not hold. Shows progress; throws as build_dynamics() and
// asked_options().
Dynamics transfer_dynamics(const TransferPair& pair, const Character& target, const Basis& basis,
                           const Dynamics& source, const std::vector<Muscle>& muscles, std::vector<std::string>& notes);

}  // namespace bodyopt::trainer
