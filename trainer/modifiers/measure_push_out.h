// How deep skin lies in skin where it folds, and what push-out leaves of it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "runtime/basis/basis.h"
#include "trainer/modifiers/shown_skin.h"

namespace bodyopt {

// Over some poses. Metres. A vertex' depth is its distance to the skin that it lies behind.
struct FoldMeasure {
  double deepest = 0, deepest_left = 0;  // of one vertex, before push-out and after it
  double sum = 0, sum_left = 0;          // of all vertices
  double elsewhere = 0;                  // how far a vertex moves at most that lay in no skin

  double removed() const { return sum > 0 ? 1 - sum_left / sum : 0; }
  void add(const FoldMeasure& other);
};

class FoldJudge {
 public:
  // The basis must have push-out.
  explicit FoldJudge(const Basis& basis);

  // One for each pose, with the weights that its modifiers have; before: without that of push-out. `searched`:
  // triangles among which folds are looked for. Nothing is measured where the body goes through itself.
  std::vector<FoldMeasure> operator()(std::span<const Pose> poses, const std::vector<std::uint32_t>& searched);
  // Among all triangles.
  std::vector<FoldMeasure> operator()(std::span<const Pose> poses);

 private:
  FoldMeasure measure(const Positions& before, const Positions& after, const Triangles& searched) const;

  const Basis& basis_;
  const Triangles triangles_;
  ShownSkin shown_;
  std::size_t component_;
  std::vector<char> kept_;     // V: in skin at rest
  Eigen::VectorXd thickness_;  // V: metres
};

// Bends of a joint that push-out was not made of, between those it was.
struct JointFolds {
  std::string joint;
  FoldMeasure measure;
};

// Of all joints whose bends fold skin, deepest first.
std::vector<JointFolds> measure_push_out(const Basis& basis);

}  // namespace bodyopt
