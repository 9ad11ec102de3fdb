// The tables of rigs/human/muscle_sections.json.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "assets/joint_roles.h"
#include "trainer/anatomy/landmark_points.h"

namespace bodyopt {

// One muscle's belly in one section of a limb.
struct SectionPlace {
  double along;  // from the limb's upper joint, 0, to its lower, 1
  double angle;  // radians, from the front towards the outside
  double share;  // of the way from the section's origin to the fascia
};

struct LimbSections {
  BodyPart from, to;   // joints
  bool is_about_bone;  // the section's origin is its bone, otherwise its middle
  struct OfMuscle {
    std::vector<std::string> names;  // of matching_name()
    std::vector<SectionPlace> places;
  };
  std::vector<OfMuscle> muscles;
};

// A whole path by landmarks, from one end to the other; what is none is the model's own end.
struct LandmarkPath {
  std::vector<std::string> names;
  std::vector<std::optional<LandmarkPoint>> points;
};

struct SectionTable {
  std::vector<LimbSections> limbs;
  std::vector<LandmarkPath> paths;
};
const SectionTable& section_table();

}  // namespace bodyopt
