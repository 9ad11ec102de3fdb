// How far a pose is from what training saw, and the error to expect of it, by region.
//   e_r^2 = fade x min(local error + growth x max(0, d^2 - usual), motion) + (1 - fade) x motion.
// Terms are in square metres over the region's vertices. The local error is what cross-validation left at the training
// frames around each centre, blended between centres by inverse distance (Shepard 1968). Growth is what that error grew
// by with d^2, where there are takes with a take left out. Motion is the error of Direct Delta Mush alone around there,
// and more beyond the centres. Older tables lack it, and nothing fades. `d` is the distance, in the region's
// coordinates, to the nearest kernel centre. Added to d^2 are the squares of how far features lie outside the trained
// range. These are the features of the region and of all joints that move its skin. Without centres that is all of it,
// and no usual distance is taken off.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/basis/basis.h"
#include "runtime/deformer/evaluation.h"

namespace bodyopt {

// The error to expect of every vertex. A region's error is spread over its vertices as the squares of what its
// components add to them: where most is learned, most is missed.
class RegionShares {
 public:
  RegionShares() = default;
  explicit RegionShares(const Basis& basis);

  // V, metres, by the error of each region (mm); 0 where nothing was learned. The squares over a region's vertices sum
  // to its squared error times its size. metres: memory that is used again.
  std::vector<float> carry(const std::vector<double>& region_mm, std::vector<float> metres = {}) const;

 private:
  struct BlockShare {
    std::uint32_t region;
    std::array<float, kBlockSize> lanes;  // of a vertex, to the mean square of the region; over all: its size
  };
  std::size_t vertex_count_ = 0;
  std::vector<std::size_t> begin_ = {0};  // blocks + 1, into shares_
  std::vector<BlockShare> shares_;
};

struct ExpectedError {
  double rms_mm = 0;              // over the skin
  double ddm_rms_mm = 0;          // of Direct Delta Mush alone; 0 where the basis does not know it
  std::vector<double> region_mm;  // per region, RMS over its vertices
};

class ErrorExpectation {
 public:
  // The basis must outlive this. Throws Error(mismatch) where it does not know its error.
  explicit ErrorExpectation(const Basis& basis);

  // The errors of frame k of an evaluation by this basis, of what that measured of the pose. May be called from any
  // thread. errors: memory that is used again.
  ExpectedError of(const Evaluation& evaluation, std::size_t k, ExpectedError errors = {}) const;

 private:
  // What an evaluation measured of a frame.
  struct Measured {
    std::span<const float> excess, coordinates, fades;
  };
  struct Energy {
    double full = 0, ddm = 0;  // square metres
  };
  Energy energy(std::size_t region, std::size_t first_centre, const Measured& frame) const;

  const Basis& basis_;
  std::vector<std::vector<std::uint32_t>> watched_;  // features, per region, ascending
  std::vector<double> centre_lengths_;               // squared, of every region's centres from rest; 0 of none
};

}  // namespace bodyopt
