// How much a breath moves a body, in the figures that physiology publishes.
#pragma once

#include <string>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

struct BreathMeasure {
  std::string name;        // "quiet"
  double litres = 0;       // that the skin gains
  double girth_share = 0;  // of the chest's girth, where it grows most: a tape around the trunk
  double belly_mm = 0;     // that the belly's wall moves at most
};

// A quiet breath, as the modifier's controls are, and a deep one, of full exertion; of the bind pose. The modifier is
// one of the basis' of the type "breathing".
std::vector<BreathMeasure> measure_breathing(const Basis& basis, const SkinModifier& modifier);

}  // namespace bodyopt
