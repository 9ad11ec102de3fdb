// Which point of one body is which of another's, as colours: what pictures of a match show.
#pragma once

#include "trainer/transfer/correspondence.h"

namespace bodyopt {

// Linear RGB of points by their place in the box around them. V x 3 metres to V x 3.
Positions place_colours(const Positions& rest);

// V' x 3: of every vertex of the target the colour of the point of the source that it is. `colours`: V x 3.
Positions matched_colours(const Correspondence& correspondence, const Positions& colours);

}  // namespace bodyopt
