// The colours of tissues, and pictures of sections in them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trainer/anatomy/section.h"

namespace bodyopt {

using Rgb = std::array<std::uint8_t, 3>;  // sRGB

// Bone ivory, fat yellow, cavity grey-blue, tendon white, other lean tissue pale red; every muscle a red or brown of
// its own, the same on both sides of the body.
class TissueColours {
 public:
  explicit TissueColours(const std::vector<Muscle>& muscles);
  Rgb of(const TissueAt& tissue) const;
  // width x height x 4, sRGB: of nothing where no tissue is; darker where two muscles, or other tissues, meet.
  // stretch: of the fibres at every pixel, times their length at rest, or empty; muscles are more orange the shorter,
  // more violet the longer they are, fullest at a third.
  std::vector<std::uint8_t> picture(const TissueSection& section, std::span<const double> stretch = {}) const;

 private:
  std::vector<Rgb> muscles_;
};

}  // namespace bodyopt
