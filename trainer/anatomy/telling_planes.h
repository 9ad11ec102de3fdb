// Where sections tell most of a body.
#pragma once

#include <string>
#include <vector>

#include "trainer/anatomy/section.h"

namespace bodyopt {

// "thigh", and the plane through it at rest.
struct NamedPlane {
  std::string name;
  SectionPlane plane;
  std::size_t joint = 0;  // that holds most of the skin there, and would take the plane along
};

// Of a human, or a limb: thigh, calf, hip, loin (L3), chest, upper arm and forearm, those whose joints are named; of
// any other body five across its longest side, evenly spaced, and one along its middle. At most `pixels` to the longer
// side.
std::vector<NamedPlane> telling_planes(const AnatomyField& field, int pixels);

}  // namespace bodyopt
