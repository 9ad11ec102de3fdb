// Whether one body may be carried to another at all.
#pragma once

#include "trainer/transfer/transfer_pair.h"

namespace bodyopt {

// Below this two bodies are unlike: see docs/transfer.md.
constexpr double kLeastLikeness = 0.36;

// 0 .. 1, the product of
// - how alike the skins are in normal and joints where they are matched, by area, the mean of both;
// - h^2, h: how much of the skin is held by joints that both have, on the body that has more of it, for a finer rig is
//   not another body;
// - exp(-d^2 - u^2), d: the other proportions of the bones, u: those of the skin, the standard deviation of the
//   logarithm of lengths along it.
// How near the fit came says where to fill in, and not whether they are alike.
double likeness(const TransferPair& pair);

}  // namespace bodyopt
