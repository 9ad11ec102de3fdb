// Tables as files of earlier versions have them.
#pragma once

#include <string>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

// The record of a region in the schema bodyopt-basis-2: kernels and weights on its features themselves.
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

// Coverage as JSON among the metadata, in millimetres and by joints' names. `basis`: with skeleton and residual.
// Regions without a name get that of their first joint. Throws Error(file) whose text starts with `origin`; counts that
// do not fit the residual are left for validate() to refuse.
CoverageTable earlier_coverage(const std::string& text, const Basis& basis, const std::string& origin);

}  // namespace bodyopt
