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

// `error`: of cross-validation by folds that all takes are in. `motions`: N, square metres, all that a frame moves. The
// error grows with the distance as it does among these frames.
ErrorModel calibrate(const HeldOutError& error, const std::vector<double>& motions);

// A frame as a fit to the other takes sees it, in one region. Energies are square metres over the region's vertices.
struct LeftOutFrame {
  int take = 0;
  double left = 0;
  double local = 0, motion = 0;  // of the nearest centre of the other takes, or of the first, where rest is nearer
  double further = 0;            // squared distance to that centre beyond what is usual
};

// `error`: of cross-validation by takes, which are its folds.
std::vector<LeftOutFrame> left_out_frames(const HeldOutError& error, const ErrorModel& model);

// Lets the error grow as it did for takes left out, if there are two takes or more: to a share of all motion at twice
// the usual distance. It is the share by which the errors expected of whole takes come nearest to what was left of
// them. A take of more than half of the frames is not asked: a range of motion is what others are learned by.
// `regions`: of each, the same frames.
void grow_by_takes(const std::vector<std::vector<LeftOutFrame>>& regions, std::vector<ErrorModel>& models);

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
