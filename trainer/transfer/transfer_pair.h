// Two bodies laid onto each other: whether one may be carried to the other, and where the source's skin lies on it.
#pragma once

#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "trainer/transfer/correspondence.h"
#include "trainer/transfer/skin_transfer.h"

namespace bodyopt::trainer {

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

// V x 3, runtime order of the source, metres, in the common pose. Places are as fitted where the match is sure, and
// everywhere for the same triangles. Elsewhere the joints warp them, and they move on as smoothly as sure ones around
// them do.
Positions sure_places(const TransferPair& pair);

// Below this two bodies are unlike: see docs/transfer.md.
constexpr double kLeastLikeness = 0.36;

// A product, 0 .. 1. The first factor is the likeness of the skins in normal and joints where they are matched, by
// area, the mean of both. The second is the square of how much skin is held by joints that both have. The body that has
// more of it counts, for a finer rig is not another body. The third is exp(-d^2 - u^2): d is the other proportions of
// the bones, u those of the skin. The latter is the standard deviation of the logarithm of lengths along it. How near
// the fit came says where to fill in, and not whether they are alike.
double likeness(const TransferPair& pair);

// How alike two bodies are, part by part: where transfer may be trusted.

// The skin that one joint of the source holds most of.
struct TransferPart {
  std::string joint;
  Eigen::Index vertices = 0;  // of the target
  double confidence = 1;      // of the match, mean by area
  double size = 1;            // lengths along the skin, of the target over the source, geometric mean
  double unevenness = 0;      // standard deviation of the logarithm of these: 0.1 is about 10 per cent
  // The match is unsure, or the part is stretched unevenly, or less than half or over twice as large as the body would
  // have it. What is carried there is a guess.
  bool breaks_assumption = false;
};

// Parts with skin on both bodies, least sure first.
std::vector<TransferPart> transfer_parts(const Basis& source, const Basis& target, const SkeletonMatch& match,
                                         const Correspondence& correspondence);

}  // namespace bodyopt::trainer
