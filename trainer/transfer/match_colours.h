// Which point of one body is which of another's, as colours and as how sure it is: what pictures of a match show.
#pragma once

#include "trainer/transfer/correspondence.h"

namespace bodyopt {

// Linear RGB of points by their place in the box around them. V x 3 metres to V x 3.
Positions place_colours(const Positions& rest);

// V' x 3: of every vertex of the target the colour of the point of the source that it is. `colours`: V x 3.
Positions matched_colours(const Correspondence& correspondence, const Positions& colours);

// V: of every vertex of the source the confidence of the target's skin where the source is laid onto it. `triangles`:
// T' x 3, the target's, runtime vertices, as all here.
Eigen::VectorXd source_confidence(const Correspondence& correspondence, const Triangles& triangles);

}  // namespace bodyopt
