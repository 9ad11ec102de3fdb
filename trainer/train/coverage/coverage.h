// Training's knowledge of its own error: how the expectations of runtime/coverage are calibrated, and used.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "runtime/basis/basis.h"
#include "runtime/coverage/expected_error.h"
#include "trainer/train/regression/regress.h"

namespace bodyopt::trainer {

// The error model of a region, see CoverageTable.
struct ErrorModel {
  std::vector<double> local;   // per centre, square metres
  std::vector<double> motion;  // per centre, square metres
  double growth = 0;           // square metres per squared unit of a coordinate, above zero where there is any error
  double usual = 0;            // mean square distance from a held-out frame to the nearest centre
};

// A fit that does without some frames, and what is left of each of them, square metres over the region's vertices.
struct HeldOutError {
  const RegressionData& data;  // its folds say which frames are fitted without which; targets are not looked at
  const Regression& regression;
  std::vector<double> left;  // N
};

// `near`: of cross-validation by folds that all takes are in. `far`: of cross-validation by takes, which are its folds;
// it has fewer than two where nothing is known of motion that was never shown. `motions`: N, square metres, all that a
// frame moves. The error grows with the distance such that half of the takes left out are off by less than expected.
// That is the median of split conformal prediction (Lei et al. 2018).
ErrorModel calibrate(const HeldOutError& near, const HeldOutError& far, const std::vector<double>& motions);

// Adds a region to a table that knows of those before, joint_begin {0} of none. `joints` of the skeleton move its skin,
// most of all first; `size`: its vertices, by their weights.
void append_region(const std::string& name, const std::vector<std::uint32_t>& joints, double size,
                   const ErrorModel& model, CoverageTable& coverage);

// Expected errors in every pose. Throws as ErrorExpectation and Deformer::evaluate.
std::vector<ExpectedError> expected_errors(const Basis& basis, const std::vector<Pose>& poses);

double root_mean_square(const std::vector<double>& values);  // 0 of none

// Spearman's rank correlation of as many values; not a number where either does not vary.
double rank_correlation(const std::vector<double>& a, const std::vector<double>& b);

// Frames (indices), `count` at most, worst first, no two of them nearer than `gap`. The gap by which so many are spread
// over the motion is spreading_gap().
std::vector<std::size_t> worth_simulating(const std::vector<double>& expected, std::size_t count, std::size_t gap);
std::size_t spreading_gap(std::size_t frames, std::size_t count);

}  // namespace bodyopt::trainer
