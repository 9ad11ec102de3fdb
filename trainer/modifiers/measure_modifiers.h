// The skin that a basis shows, as geometry is computed on, and how far each modifier moves it.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "runtime/basis/basis.h"
#include "trainer/motion/joint_limits.h"

namespace bodyopt {
class Deformer;
}

namespace bodyopt::trainer {

class EvaluatedSkin {
 public:
  explicit EvaluatedSkin(Basis basis);
  ~EvaluatedSkin();
  // One for each pose: V x 3, runtime order, metres, world, quasi-static, on the CPU.
  std::vector<Positions> operator()(std::span<const Pose> poses);

 private:
  std::unique_ptr<Deformer> deformer_;
};

// The basis without the tables of its modifiers.
Basis without_modifiers(Basis basis);

// How far a modifier that is switched on moves the skin, over some poses.
struct ModifierMove {
  std::string modifier;
  double largest = 0;    // metres, of one vertex, beside the skin without this modifier alone
  std::size_t pose = 0;  // in which it is
};

// Ordered as the stack. `poses` have the weights of the basis' modifiers (drive_modifiers). The skin is quasi-static.
std::vector<ModifierMove> measure_moves(const Basis& basis, std::span<const Pose> poses);

// How much a breath moves a body, in the figures that physiology publishes.

struct BreathMeasure {
  std::string name;        // "quiet"
  double litres = 0;       // that the skin gains
  double girth_share = 0;  // of the chest's girth, where it grows most: a tape around the trunk
  double belly_mm = 0;     // that the belly's wall moves at most
};

// A quiet breath, as the modifier's controls are, and a deep one, of full exertion; of the bind pose. The modifier is
// one of the basis' of the type "breathing".
std::vector<BreathMeasure> measure_breathing(const Basis& basis, const SkinModifier& modifier);

// How deep skin lies in skin where it folds, and what push-out leaves of it.

// Over some poses. Metres. A vertex' depth is its distance to the skin that it lies behind
// (geometry/self_intersections.h).
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

}  // namespace bodyopt::trainer
