// A modifier that has been worked out for every frame.
#pragma once

#include <filesystem>
#include <vector>

#include "trainer/curate/modifier_type.h"
#include "trainer/train/regression/components.h"

namespace bodyopt {

// Adds to a frame's offsets its row of `changes`. `rows`: of every frame of the database its row, -1: none.
std::unique_ptr<ShapeModifier> stored_offsets(Displacements changes, std::vector<int> rows);

// The same from a file of input.cache, null where there is none that fits; and one written for the next time.
std::unique_ptr<ShapeModifier> cached_offsets(const std::filesystem::path& cache, std::size_t vertices,
                                              const std::vector<int>& rows);
void cache_offsets(const Displacements& changes, const std::filesystem::path& cache);

}  // namespace bodyopt
