// How alike two bodies are, part by part: where transfer may be trusted.
#pragma once

#include <string>
#include <vector>

#include "trainer/transfer/correspondence.h"

namespace bodyopt {

// The skin that one joint of the source holds most of.
struct TransferPart {
  std::string joint;
  Eigen::Index vertices = 0;  // of the target
  double confidence = 1;      // of the match, mean by area
  double size = 1;            // lengths along the skin, of the target over the source, geometric mean
  double unevenness = 0;      // standard deviation of the logarithm of these: 0.1 is about 10 per cent
  // The match is unsure, or the part is less than half or more than twice as large as the body would have it, or
  // stretched unevenly: what is carried there is a guess.
  bool breaks_assumption = false;
};

// Parts with skin on both bodies, least sure first.
std::vector<TransferPart> transfer_parts(const Basis& source, const Basis& target, const SkeletonMatch& match,
                                         const Correspondence& correspondence);

}  // namespace bodyopt
