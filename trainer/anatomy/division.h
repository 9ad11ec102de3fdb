// Lean tissue divided among muscles, each of the volume that anatomists measure.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "trainer/anatomy/inner_tissue.h"
#include "trainer/anatomy/muscle_candidates.h"

namespace bodyopt::trainer {

// The muscles of one half of a body, numbered as in `muscles`.
struct Division {
  struct OfMuscle {
    int muscle = -1;                      // in the list given
    std::vector<int> slips;               // in that list: all that share this region alike, `muscle` among them
    Positions path;                       // 48 x 3, half space: drawn to its bones and to the middle of its own region
    double belly_from = 0, belly_to = 1;  // along the path
    double volume = 0, target = 0;        // cubic metres; target: a table's, scaled, or else what its radius says
    int pieces = 0;                       // of its region, connected through faces of cells
    double ends_off_bone[2] = {0, 0};     // metres: origin, insertion; to the nearest bone of its joints
    int end_joint[2] = {-1, -1};          // the bones that its ends are tied to
    std::string limb;                     // of limb_factors; empty: none
  };
  std::vector<OfMuscle> muscles;
  std::vector<int> label;                      // S: in `muscles` above, -1: none
  std::vector<bool> is_tendon;                 // S: lies on a tendon of the muscle in `label`
  Positions fibre;                             // S x 3: unit, from origin to insertion; zero where no muscle is
  std::map<std::string, double> limb_factors;  // by how much the published volumes were scaled, limb by limb
};

// corrections: of volumes, by the muscles' names in the list; they count as asked for, beside limb factors.
Division divide_muscles(const HalfBody& body, const BodyGrid& grid, const InnerTissue& tissue,
                        const std::vector<Muscle>& muscles, const AnatomyCorrections& corrections = {});

// The steps of divide_muscles() in their order: paths, targets, and last fibres.

// Models have paths as lines of action: this moves their middles to where rigs/human/muscle_sections.json has them, if
// a body has the joints and landmarks. Then parts of bellies outside of lean tissue move to the nearest.
void guide_paths(const HalfBody& body, const LeanSamples& lean, std::vector<HalfMuscle>& muscles);

// The volumes that muscles should have in a body: published ones, scaled to its limbs.
struct LimbTargets {
  std::vector<double> volume;             // M, cubic metres
  std::map<std::string, double> factors;  // of each limb that muscles of a table belong to
};

// One factor a limb, so that the muscles in it fill its lean tissue but for a tenth or so (fasciae, vessels, nerves).
// The parts of a muscle share its volume as their own 2 r^2 l; a muscle that no table has keeps that.
LimbTargets limb_targets(const LeanSamples& lean, const std::vector<HalfMuscle>& muscles);

// L x 3: unit, from origin to insertion, along the gradient of a harmonic function; zero without a label. It solves
// Laplace's equation without flux through the region's sides (Choi and Blemker 2013). It is 0 where the half of the
// region next to the origin touches the origin's bone, 1 where the other half touches the insertion's. An end without
// contact holds the outer 7 % of the samples along the path.
// `label`, `along` (L): each sample's muscle, and its place along that muscle's path, 0 to 1. `joints` (M): of the
// bones at origin and insertion.
Positions fibre_directions(const LeanSamples& lean, const std::vector<HalfMuscle>& muscles,
                           const std::vector<std::array<int, 2>>& joints, const std::vector<int>& label,
                           const std::vector<double>& along);

}  // namespace bodyopt::trainer
