// How far a pose is from what training saw, and the error to expect of it.
//   e_r^2 = fade x (local error + distance x (what the nearest kernel centre is further away than usual, squared))
//           + (1 - fade) x motion
// per region, in square metres over its vertices. The local error is what cross-validation left at the training frames
// around each centre, blended between centres by inverse distance (Shepard 1968); the second term is what that error
// grew by with the distance from what was learned. Motion is what Direct Delta Mush alone was off by around there:
// neither is more than that, and where the correction fades it is what is left. Distances are those of the region's
// coordinates; how far features lie outside the trained range, those of the region and those of all joints that move
// its skin, is added to them, squares to squares.
#pragma once

#include <string>
#include <vector>

#include "assets/character.h"
#include "runtime/basis/basis.h"
#include "trainer/train/regression/components.h"
#include "trainer/train/regression/regress.h"

namespace bodyopt {

struct ErrorModel {
  std::vector<double> local;   // per centre, square metres
  std::vector<double> motion;  // per centre, square metres; none in files of older versions: not known
  double distance = 0;         // square metres per squared unit of a coordinate, above zero where there is any error
  double usual = 0;            // mean square distance from a held-out frame to the nearest centre
  std::vector<double>
      metric;  // per coordinate, what its squared differences count; none: all 1 (older versions differ)
};

// From the held-out frames of cross-validation, each with the centres of other folds only. Of every frame, in square
// metres over the region's vertices, `left`: what is left of it, and `motions`: all of it. Targets are not looked at.
ErrorModel calibrate(const RegressionData& data, const Regression& regression, const std::vector<double>& left,
                     const std::vector<double>& motions);

// A region as a basis' metadata "coverage" tells it.
struct RegionCoverage {
  std::string name;
  std::vector<std::string> joints;  // that move its skin, most of all first
  double size = 0;                  // vertices, by their weights
  ErrorModel expected;
};

// False for Direct Delta Mush alone, which was trained without shapes.
bool has_coverage(const Basis& basis);
std::string coverage_text(const std::vector<RegionCoverage>& regions);
// Regions without a name, as older versions wrote them, get that of their first joint. Throws Error(mismatch) where
// the basis has none, Error(file) where it is damaged.
std::vector<RegionCoverage> read_coverage(const Basis& basis);

struct ExpectedError {
  double rms_mm = 0;              // over the skin
  std::vector<double> region_mm;  // per region, RMS over its vertices
};

ExpectedError expected_error(const Basis& basis, const std::vector<RegionCoverage>& regions, const Pose& pose);
// Of every pose.
std::vector<ExpectedError> expected_errors(const Basis& basis, const std::vector<RegionCoverage>& regions,
                                           const std::vector<Pose>& poses);

double root_mean_square(const std::vector<double>& values);  // 0 of none

// Spearman's rank correlation of as many values; not a number where either does not vary.
double rank_correlation(const std::vector<double>& a, const std::vector<double>& b);

// At most `count` frames (indices), worst first, no two of them nearer than `gap`; and the gap by which so many are
// spread over the motion.
std::vector<std::size_t> worth_simulating(const std::vector<double>& expected, std::size_t count, std::size_t gap);
std::size_t spreading_gap(std::size_t frames, std::size_t count);

}  // namespace bodyopt
