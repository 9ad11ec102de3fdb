// Subcutaneous fat: how it is spread over a body, and how much there is.
#pragma once

#include "trainer/anatomy/human_frame.h"

namespace bodyopt {

// V, metres, skin left out: of a man of 15 % body fat. Only the pattern counts, fit_fat() finds the scale.
Eigen::VectorXd human_fat_pattern(const BodySurvey& survey, const HumanFrame& frame);

// A pattern times what a correction says of regions and joints, by how much skin follows them.
Eigen::VectorXd corrected_pattern(const BodySurvey& survey, const Eigen::VectorXd& pattern,
                                  const AnatomyCorrections& corrections);

struct FatFit {
  Eigen::VectorXd thickness;  // V, metres: skin and fat
  double body_fat = 0;        // of the body's mass: what was asked for, or the most that the body has room for
};
// So thick that the fat under the skin is four fifths of a body's fat, the rest of which lies inside; never more than
// 0.45 of the way to the middle of a limb. skin: metres.
FatFit fit_fat(const BodySurvey& survey, const Eigen::VectorXd& pattern, double skin, double body_fat);

// Gives a survey its fat and tissue the field of it, with a note where the body had no room for what was asked.
void take_fat(BodySurvey& survey, const FatFit& fit, double asked, InnerTissue& tissue);

}  // namespace bodyopt
