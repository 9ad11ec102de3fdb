// Where the source's skin lies on the target, with what is unsure of it filled in.
#pragma once

#include "trainer/transfer/transfer_pair.h"

namespace bodyopt {

// V x 3, runtime order of the source, metres, in the common pose: as fitted where the match is sure, and everywhere for
// the same triangles; elsewhere as the joints warp it, moved as smoothly as what is sure around it was moved from
// there.
Positions sure_places(const TransferPair& pair);

}  // namespace bodyopt
