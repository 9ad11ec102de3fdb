// Lean tissue divided among muscles, each of the volume that anatomists measure.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "trainer/anatomy/inner_tissue.h"

namespace bodyopt {

// Of one half of a body; muscles are those of this half, numbered as in `muscles`.
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

}  // namespace bodyopt
