// A source and a target, and all that is known of how the one becomes the other.
#pragma once

#include <memory>

#include "assets/character.h"
#include "trainer/transfer/skin_transfer.h"

namespace bodyopt {

struct TransferOptions {
  std::string joint_map{};  // joint_map.json from the source's joints to the target's; empty: names tell
  std::vector<SkinMarker> markers{};
  TransferSize size = TransferSize::local;
  double tolerance = 2e-5;  // metres, root mean square: what is left out of the columns of a basis, and rounded
};

// Members refer to each other: it stays where it is.
struct TransferPair {
  // `source`: needs skeleton, mesh and ddm. The target's Direct Delta Mush smooths as far as the source's in its size.
  // Throws as match_skeletons() and match_skins().
  TransferPair(const Basis& source, const Character& target_character, const TransferOptions& options);
  TransferPair(const TransferPair&) = delete;
  TransferPair& operator=(const TransferPair&) = delete;

  const Basis& source;
  SkeletonMatch match;
  Basis target;  // Direct Delta Mush and nothing else
  Correspondence correspondence;
  SkinTransfer skin;
};

}  // namespace bodyopt
