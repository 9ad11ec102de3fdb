// What of a body its tetrahedra are: bones, muscles, parts that go with joints.
#pragma once

#include <vector>

#include "assets/muscles.h"
#include "trainer/simulate/bone_springs.h"

namespace bodyopt {

struct JiggleAnatomy {
  TetTissue tissue;
  SparseMatrix bone_springs;     // N x N, N/m
  NodeWeights joint_share;       // N x J, rows sum to 1
  std::vector<bool> is_end;      // J: a limb ends with this joint (a head, hand, foot, tip of a tail)
  Eigen::MatrixXd muscle_share;  // N x M: the part of a node's tissue that each muscle is
};

// As simulation finds them in a cage. field: of the character and its muscles, of which there are so many.
JiggleAnatomy find_anatomy(const Character& character, const AnatomyField& field, std::size_t muscle_count,
                           const Cage& cage, const Materials& materials);

}  // namespace bodyopt
