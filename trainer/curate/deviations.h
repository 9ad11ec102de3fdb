// How far every frame's shape is from what other passes by its pose say.
#pragma once

#include <functional>
#include <vector>

#include "trainer/curate/local_models.h"
#include "trainer/train/regression/components.h"

namespace bodyopt {

// N x 3 part vertices, of every frame, un-posed, metres: what its pass alone has there. `displacements`: N x 3V. Zero
// where nothing else passes by.
Displacements part_deviations(const Displacements& displacements, const SkinPart& part, const LocalModels& models);

// The displacements of every frame, N x 3V. Shows progress under a title.
Displacements all_displacements(const PoseDatabase& database, const std::string& title,
                                const std::function<Positions(std::size_t frame)>& offsets);

}  // namespace bodyopt
