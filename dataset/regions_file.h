// regions.json: regions of the skin that people painted or edited.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "dataset/dataset.h"
#include "geometry/region_weights.h"

namespace bodyopt {

// The regions of the file that the dataset names; none where it names none. Welded vertices take the largest weight of
// their output vertices. Weights sum to 1 at most, everywhere to 1 in a complete file. Throws Error(file) at a
// malformed or missing file. Throws Error(mismatch) at weights of another character, a region without any, or an
// uncovered vertex of a complete file.
std::vector<RegionWeights> read_regions(const Dataset& dataset, const Character& character);

// Writes regions (of welded vertices) that cover the skin as a complete file of output vertices. `source`: where they
// come from, for who edits the file.
void write_regions(const std::vector<RegionWeights>& regions, const Character& character,
                   const std::filesystem::path& path, const std::string& source = {});
// The text of that file.
std::string regions_text(const std::vector<RegionWeights>& regions, const Character& character,
                         const std::string& source = {});

}  // namespace bodyopt
