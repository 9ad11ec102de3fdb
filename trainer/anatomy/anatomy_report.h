// The composition of a body in numbers: by its parts and by its muscles.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "trainer/anatomy/field.h"
#include "trainer/anatomy/section.h"

namespace bodyopt::trainer {

struct AnatomyReport {
  struct OfPart {
    std::string name;
    double volume = 0;  // cubic metres
    // Shares of it; sum 1. Tendons and the brain count among other_lean.
    double bone = 0, fat = 0, cavity = 0, muscle = 0, other_lean = 0;
  };
  struct OfMuscle {
    std::string name;
    double volume = 0, target = 0;              // cubic metres; target: a table's, scaled, or else of its radius
    int pieces = 0;                             // connected ones
    std::array<double, 2> ends_off_bone{0, 0};  // metres: origin, insertion
    std::array<std::string, 2> bones;           // joints that they are tied to; empty: none
  };
  std::vector<OfPart> parts;      // both sides together, those that the body has; last "body", all of it
  std::vector<OfMuscle> muscles;  // as the list of muscles has them
  std::map<std::string, double> limb_factors;
  // The largest difference between left and right over their mean: of a part's volume, of its bone, fat or muscle, or
  // of a muscle's volume. It is found by looking at the field on both sides. Nothing: the body has no sides.
  std::optional<double> mirror_difference;
  // One sentence each: where skin and paths do not fit each other, and what could not be placed.
  std::vector<std::string> warnings;
};

// Asks tissue_at() at every sample of the grid and, where one half stands for both, at its mirror image.
AnatomyReport report_anatomy(const Character& character, const std::vector<Muscle>& muscles, const AnatomyField& field);

// One sentence on where the skin passes through itself, and so parts' volumes are not their own; empty: nowhere.
std::string skin_crossing(const Character& character);

// The colours of tissues, and pictures of sections in them.

using Rgb = std::array<std::uint8_t, 3>;  // sRGB

// Bone is ivory, fat yellow, cavity grey-blue, tendon white, other lean tissue pale red. Every muscle has a red or
// brown of its own, the same on both sides of the body.
class TissueColours {
 public:
  explicit TissueColours(const std::vector<Muscle>& muscles);
  Rgb of(const TissueAt& tissue) const;
  // width x height x 4, sRGB: transparent where there is no tissue, darker where two muscles or other tissues meet.
  // `stretch`: of the fibres at every pixel, times their length at rest, or empty. Shorter muscles are more orange,
  // longer ones more violet, fullest at a third.
  std::vector<std::uint8_t> picture(const TissueSection& section, std::span<const double> stretch = {}) const;

 private:
  std::vector<Rgb> muscles_;
};

}  // namespace bodyopt::trainer
