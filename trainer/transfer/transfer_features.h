// The part of a trained residual that turns features into coefficients, rewritten for another character's features.
#pragma once

#include <string>
#include <vector>

#include "trainer/transfer/feature_map.h"

namespace bodyopt {

// Regions then read the target's features and give the same coefficients as the source's did: exactly where features
// are only renamed; otherwise projections are multiplied by the formulas, and centres moved by their constants, to the
// rounding of halves; what lies outside the trained range is clamped in the target's axes. The fade is carried where no
// formula has a constant and no chain of joints differs; otherwise it is left out, with a note. `blend` is left alone.
void transfer_features(const std::vector<FeatureFormula>& formulas, const Skeleton& source, const Skeleton& target,
                       const SkeletonMatch& match, ResidualTable& residual, std::vector<std::string>& notes);

}  // namespace bodyopt
