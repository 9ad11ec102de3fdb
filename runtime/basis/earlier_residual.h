// Residuals as files of the schema bodyopt-basis-2 have them: kernels and weights on a region's features themselves.
#pragma once

#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

// The record of a region there.
struct EarlierRegion {
  std::uint32_t feature_begin, feature_count;
  std::uint32_t centre_begin, centre_count;
  std::uint32_t centre_values;
  std::uint32_t coefficient_begin, coefficient_count;
  std::uint32_t weight_values;
  float inverse_width2;
};
static_assert(sizeof(EarlierRegion) == 36);

// Gives the residual regions whose coordinates are their features, each of which it takes once: the same results, bit
// for bit. Counts that do not fit are left for validate() to refuse.
void take_earlier_regions(const std::vector<EarlierRegion>& earlier, ResidualTable& residual);

}  // namespace bodyopt
