// regions.json: regions of the skin that people painted or edited.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "assets/character.h"
#include "dataset/dataset.h"
#include "geometry/region_weights.h"

namespace bodyopt {

// The regions of the file that the dataset names, on welded vertices (which take the largest weight of their output
// vertices); none where it names none. Weights sum to 1 at most, everywhere to 1 where the file says that it is
// complete. Throws Error(file) at what is malformed or not there, Error(mismatch) where the weights are of another
// character, a region has none, or a complete file leaves a vertex uncovered.
std::vector<RegionWeights> read_regions(const Dataset& dataset, const Character& character);

// Writes regions (of welded vertices) that cover the skin as a complete file of output vertices. `source`: where they
// come from, for who edits the file.
void write_regions(const std::vector<RegionWeights>& regions, const Character& character,
                   const std::filesystem::path& path, const std::string& source = {});
// The text of that file.
std::string regions_text(const std::vector<RegionWeights>& regions, const Character& character,
                         const std::string& source = {});

}  // namespace bodyopt
