// What of a body its tetrahedra are: bones, muscles, parts that go with joints.
#pragma once

#include <vector>

#include "assets/muscles.h"
#include "trainer/simulate/bone_springs.h"
#include "trainer/simulate/muscle_fibres.h"

namespace bodyopt {

struct JiggleAnatomy {
  std::vector<BonePoint> bones;
  SparseMatrix bone_springs;           // N x N, N/m
  NodeWeights joint_share;             // N x J, rows sum to 1
  std::vector<bool> is_end;            // J: a limb ends with this joint (a head, hand, foot, tip of a tail)
  std::vector<double> muscle_of_tets;  // T: the share that is muscle
  Eigen::MatrixXd muscle_share;        // N x M: the part of a node's tissue that each muscle is
};

// As simulation finds them in a cage. Throws Error(mismatch) where a muscle is bound to a joint the skeleton lacks.
JiggleAnatomy find_anatomy(const Character& character, const std::vector<Muscle>& muscles, const Cage& cage,
                           const Materials& materials);

}  // namespace bodyopt
