// The volumes that muscles should have in a body: published ones, scaled to its limbs.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "trainer/anatomy/lean_samples.h"
#include "trainer/anatomy/muscle_paths.h"

namespace bodyopt {

struct LimbTargets {
  std::vector<double> volume;             // M, cubic metres
  std::map<std::string, double> factors;  // of each limb that muscles of a table belong to
};

// One factor a limb, so that the muscles in it fill its lean tissue but for a tenth or so (fasciae, vessels, nerves).
// The parts of a muscle share its volume as their own 2 r^2 l; of a muscle that no table has, that is what is wanted.
LimbTargets limb_targets(const LeanSamples& lean, const std::vector<HalfMuscle>& muscles);

}  // namespace bodyopt
