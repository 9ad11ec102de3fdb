// What divide_muscles() does one after the other: paths, targets, and last fibres.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "trainer/anatomy/inner_tissue.h"
#include "trainer/anatomy/muscle_paths.h"

namespace bodyopt {

// Moves the middles of paths, which models have as lines of action, to where rigs/human/muscle_sections.json has them,
// where a body has the joints and landmarks for it; then those parts of bellies that do not lie in lean tissue to the
// nearest that do.
void guide_paths(const HalfBody& body, const LeanSamples& lean, std::vector<HalfMuscle>& muscles);

// The volumes that muscles should have in a body: published ones, scaled to its limbs.
struct LimbTargets {
  std::vector<double> volume;             // M, cubic metres
  std::map<std::string, double> factors;  // of each limb that muscles of a table belong to
};

// One factor a limb, so that the muscles in it fill its lean tissue but for a tenth or so (fasciae, vessels, nerves).
// The parts of a muscle share its volume as their own 2 r^2 l; of a muscle that no table has, that is what is wanted.
LimbTargets limb_targets(const LeanSamples& lean, const std::vector<HalfMuscle>& muscles);

// L x 3: unit, from origin to insertion, along the gradient of a harmonic function (Laplace's equation, no flux through
// the region's sides; Choi and Blemker 2013), zero without a label. It is 0 where the region touches the bone of the
// muscle's origin in the path's first half, 1 where it touches that of its insertion in the other; where there is no
// contact, on the outer 7 % along the path.
// label, along (L): each sample's muscle, and its place along that muscle's path, 0 to 1; joints (M): of the bones at
// origin and insertion.
Positions fibre_directions(const LeanSamples& lean, const std::vector<HalfMuscle>& muscles,
                           const std::vector<std::array<int, 2>>& joints, const std::vector<int>& label,
                           const std::vector<double>& along);

}  // namespace bodyopt
