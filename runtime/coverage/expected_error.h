// How far a pose is from what training saw, and the error to expect of it.
//   e_r^2 = fade x (local error + growth x (what the nearest kernel centre is further away than usual, squared))
//           + (1 - fade) x motion
// per region, in square metres over its vertices. The local error is what cross-validation left at the training frames
// around each centre, blended between centres by inverse distance (Shepard 1968); the second term is what that error
// grew by with the distance from what was learned, where there are takes with that of a take left out. Motion is what
// Direct Delta Mush alone was off by around there, and more beyond the centres: neither is more than that, and where
// the correction fades it is what is left. Distances are those of the region's coordinates; how far features lie
// outside the trained range, those of the region and those of all joints that move its skin, is added to them, squares
// to squares.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

// The error to expect of every vertex. What coverage says of a region is spread over its vertices as the squares of
// what its components add to them: where most is learned, most is missed.
class RegionShares {
 public:
  RegionShares() = default;
  explicit RegionShares(const Basis& basis);

  // V, metres, of as many errors as there are regions; 0 where nothing was learned. Summed in squares over a region's
  // vertices it is what the region's error is over as many as its size.
  std::vector<float> carry(const std::vector<double>& region_mm) const;

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

  // From any thread. `strains`: of the pose, one a fibre. Controls that the pose lacks are 0.
  ExpectedError of(const Pose& pose, std::span<const float> strains) const;

 private:
  // What the residual knows of a pose.
  struct PoseFeatures {
    std::vector<float> coordinates, excess;  // of all regions; of all features
    std::vector<float> fades;                // of all regions
  };

  PoseFeatures features_of(const Pose& pose, std::span<const float> strains) const;
  struct Energy {
    double full = 0, ddm = 0;  // square metres
  };
  Energy energy(std::size_t region, std::size_t first_centre, const PoseFeatures& features) const;

  const Basis& basis_;
  std::vector<std::vector<std::uint32_t>> watched_;  // features, per region, ascending
  std::vector<double> centre_lengths_;               // squared, of every region's centres from rest; 0 of none
};

}  // namespace bodyopt
