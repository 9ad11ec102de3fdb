// How far every frame's shape is from what other passes by its pose say.
#pragma once

#include <functional>
#include <vector>

#include "trainer/curate/local_models.h"
#include "trainer/train/regression/components.h"

namespace bodyopt {

// 3 per vertex of the part, of the frame that has these shares, un-posed, metres: what its pass alone has there; zero
// where there are no shares. `displacements`: N x 3V.
Eigen::RowVectorXf frame_deviation(const Displacements& displacements, const SkinPart& part,
                                   const std::vector<FrameShare>& shares);

// N x 3 part vertices, of every frame, un-posed, metres: what its pass alone has there. `displacements`: N x 3V. Zero
// where nothing else passes by.
Displacements part_deviations(const Displacements& displacements, const SkinPart& part, const LocalModels& models);

// The displacements of every frame, N x 3V. Shows progress under a title.
Displacements all_displacements(const PoseDatabase& database, const std::string& title,
                                const std::function<Positions(std::size_t frame)>& offsets);

}  // namespace bodyopt
