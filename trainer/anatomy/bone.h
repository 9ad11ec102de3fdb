// Bones as shapes, and the field that they make together.
#pragma once

#include <functional>
#include <vector>

#include "trainer/anatomy/body_survey.h"

namespace bodyopt {

struct Bone {
  int joint = -1;
  double cover = 0;                             // metres of other tissue between it and the skin, at least
  std::function<double(const Spot&)> distance;  // to its surface, metres; negative inside
};

// Farther from bones than this, fields say just so: metres, of a body of 1.75 m.
constexpr double kFarFromBone = 0.08;

// Without those of joints that carry none by a correction, and as much thicker as one says.
std::vector<Bone> corrected_bones(const std::vector<Bone>& bones, const HalfBody& body,
                                  const AnatomyCorrections& corrections);

// Into tissue.bone and tissue.bone_joint: of each sample the nearest bone, -1 where there is none.
void find_bone(const BodySurvey& survey, const std::vector<Bone>& bones, InnerTissue& tissue);

}  // namespace bodyopt
