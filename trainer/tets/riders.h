// Riders: loose pieces that follow a body, as hair cards, fins, eyes, teeth and buttons do.
#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "trainer/tets/fillable_skin.h"

namespace bodyopt {

class SparseSolver;

// What rides has no tets. It takes the displacement of the body where it touches it, spread along its own surface: it
// moves as one piece of stuff, whatever other part of the body happens to be near. Where a sheet shares edges with the
// body it is held there; any other piece is held where it comes nearest to skin that follows the same joints. From
// there every value is the mean of those around it, weighed by one over the length of the edges (a harmonic map).
class Riders {
 public:
  Riders() = default;  // nothing rides
  // `vertices` (V x 3, rest, metres), `triangles`, `weights`: of the whole skin that was mended.
  Riders(const FillableSkin& fillable, const Positions& vertices, const Triangles& triangles,
         const SkinWeights& weights);

  const std::vector<std::uint32_t>& vertices() const { return vertices_; }  // R, of the skin, ascending
  bool empty() const { return vertices_.empty(); }

  // Values at the vertices of the skin (V x 3; those of riders are not looked at) spread to what rides, R x 3. A
  // constant stays constant.
  Positions spread(const Positions& values) const;

 private:
  using Matrix = Eigen::SparseMatrix<double>;
  std::vector<std::uint32_t> vertices_;
  std::vector<int> unknown_;                    // R: vertices merged with another share its unknown
  Matrix held_;                                 // unknowns x V: what holds each
  std::shared_ptr<const SparseSolver> solver_;  // null where nothing rides
};

}  // namespace bodyopt
