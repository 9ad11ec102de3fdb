// Subcutaneous fat: how it is spread over a body, and how much there is.
#pragma once

#include "trainer/anatomy/human_frame.h"

namespace bodyopt {

// V, metres, skin left out: of a man of 15 % body fat. Only the pattern counts, lay_fat() finds the scale.
Eigen::VectorXd human_fat_pattern(const BodySurvey& survey, const HumanFrame& frame);

// Gives a survey its fat and tissue the field of it: a pattern (V), times what corrections say of regions and joints,
// by how much skin follows them. So thick that the fat under the skin is four fifths of a body's fat, the rest of which
// lies inside; never more than 0.45 of the way to the middle of a limb; with a note where the body has no room for what
// is asked. skin: metres.
void lay_fat(BodySurvey& survey, const Eigen::VectorXd& pattern, double skin, const InnerTissueOptions& options,
             InnerTissue& tissue);

}  // namespace bodyopt
