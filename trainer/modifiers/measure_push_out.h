// How deep skin lies in skin where it folds, and what push-out leaves of it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "trainer/modifiers/evaluated_skin.h"
#include "trainer/motion/joint_limits.h"

namespace bodyopt {

// Over some poses. Metres. A vertex' depth is its distance to the skin that it lies behind (geometry/skin_in_skin.h).
struct FoldMeasure {
  double deepest = 0, deepest_left = 0;  // of one vertex, before push-out and after it
  double sum = 0, sum_left = 0;          // of all vertices
  double elsewhere = 0;                  // how far push-out moves a vertex at most that lay in no skin

  double removed() const { return sum > 0 ? 1 - sum_left / sum : 0; }
  void add(const FoldMeasure& other);
};

class FoldJudge {
 public:
  // The basis must have push-out, and outlive this.
  explicit FoldJudge(const Basis& basis);

  // One for each pose, with the weights that its modifiers have; before: without that of push-out. What lies in skin at
  // rest is left out. What later modifiers make of the skin that was moved is no move of push-out's.
  std::vector<FoldMeasure> operator()(std::span<const Pose> poses);

 private:
  FoldMeasure measure(const Positions& before, const Positions& after) const;
  double elsewhere(const Positions& before, const Positions& after) const;

  const Basis& basis_;
  const Triangles triangles_;
  EvaluatedSkin shown_;
  std::vector<char> kept_;  // V: in skin at rest
};

struct BentJoint {
  std::string joint;
  FoldMeasure measure;
};

// Deepest first; what folds no skin is left out. Joints bent by 130 degrees: those of slender limbs that bend one way,
// as the rest pose tells: elbows, knees, fingers.
std::vector<BentJoint> measure_push_out(const Basis& basis);
// Every degree of freedom at either of its limits, by its name and the angle, degrees.
std::vector<BentJoint> measure_push_out(const Basis& basis, const JointLimits& limits);

}  // namespace bodyopt
