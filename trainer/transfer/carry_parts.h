// Muscles and painted regions, carried to another body.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "assets/characters/muscles.h"
#include "dataset/dataset.h"
#include "geometry/region_weights.h"
#include "trainer/transfer/transfer_pair.h"

namespace bodyopt::trainer {

// Each point goes with its joint, scaled as the joint's bones are, and on from there as the fit moves the skin around
// it. That skin counts by inverse distance to the fourth power (Shepard 1968). Radii are scaled alike. A muscle of a
// joint that the target lacks is held by the nearest joint above; without one it is left out, with a note.
std::vector<Muscle> carried_muscles(const TransferPair& pair, const std::vector<Muscle>& muscles,
                                    std::vector<std::string>& notes);

// Regions on the source's runtime vertices to regions on the target's: as they are where the match is sure, elsewhere
// filled in smoothly.
std::vector<RegionWeights> carried_regions(const TransferPair& pair, const std::vector<RegionWeights>& regions);

// The modifiers of a dataset's curation, carried with it to another character.

// The source's stack for the carried takes, which have the same names and frames. Joints get the target's names;
// lengths ("..._mm") change by the target's size. Sculpted offsets are carried as shapes are, into files under `out`.
// Modifiers with joints of which the target has none, "blend", whose cache is of the source, and "symmetry" of a target
// that is not its own mirror image stay in the stack, disabled, with a note. Throws Error(file), and Error(mismatch)
// for offsets of another mesh.
std::vector<Modifier> carried_modifiers(const Dataset& dataset, const Character& source_character,
                                        const Character& target, const TransferPair& pair,
                                        const std::filesystem::path& out, std::vector<std::string>& notes);

// Its named selections, with the target's joints.
std::vector<NamedSelection> carried_selections(const Dataset& dataset, const TransferPair& pair);

}  // namespace bodyopt::trainer
