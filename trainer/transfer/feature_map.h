// What the source's features are, told by those of the target.
#pragma once

#include <vector>

#include "runtime/basis/basis.h"
#include "trainer/transfer/match_skeletons.h"

namespace bodyopt {

// One feature of the source: constant + sum of factor x feature of the target.
struct FeatureFormula {
  struct Term {
    std::uint32_t feature;
    double factor;
  };
  std::vector<Term> terms;
  double constant = 0;

  bool is_renamed() const { return terms.size() == 1 && terms[0].factor == 1 && constant == 0; }
};

// Of every feature of the source: joint features, strains, controls. `strain_at_rest`: strains of the source's fibres
// where it is posed as the target rests. With the alignments C of a joint k and of the joint a above it that both
// characters have, R_k = C_a R'_k C_k^T; where the target has joints between the two, their rotations are multiplied to
// first order. Joints that the target does not have do not turn.
std::vector<FeatureFormula> feature_formulas(const Basis& source, const Skeleton& target, const SkeletonMatch& match,
                                             const std::vector<float>& strain_at_rest);

// The pose of the source in which it stands as the target rests.
Pose pose_at_target_rest(const SkeletonMatch& match, const Skeleton& source);

}  // namespace bodyopt
