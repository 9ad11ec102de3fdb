// Bones: the parts of the inside that move rigidly with a joint.
#pragma once

#include <vector>

#include "assets/character.h"
#include "trainer/simulate/metric.h"
#include "trainer/tets/cage.h"

namespace bodyopt {

// Joint weights of every node, N x J: rows sum to one.
using NodeWeights = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// A piece of bone inside a tet.
struct BonePoint {
  int tet;
  int joint;
  Eigen::Vector4d weights;  // barycentric
  double volume;            // cubic metres
};

// Samples the tets for bone. A point belongs to the bone of joint j where j's weight is at least one half and
//  - it lies in a capsule along one of j's segments (to each child, or, without children, along the skin the joint
//    carries), 0.35 of the local distance to the skin thick and thinning to nothing at hinges, where tissue of both
//    sides must be free to slide and fold; or
//  - it is j's own core: weight at least 0.9 and deeper than 0.65 of the deepest such point (heads, palms; a root,
//    which is a trunk: 0.3).
std::vector<BonePoint> find_bones(const TetMesh& mesh, const Character& character, const NodeWeights& weights);

// The same at the samples of a cage, but that fingers and toes, whose joint may carry a whole hand, have a core of
// their own: deeper than 0.65 of the distance to their own middle. A joint left without bone, as in a sheet too thin
// for capsules, takes all samples of weight 0.9 or more.
std::vector<BonePoint> find_bones(const Cage& cage, const Character& character, const NodeWeights& weights);

}  // namespace bodyopt
