#include "trainer/train/coverage/coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/parallel.h"
#include "base/progress.h"
#include "trainer/train/features/features.h"

namespace bodyopt {
namespace {

using Eigen::Index;

// The slope of the least squares of y ~ a + b x, not below zero.
double growth(const std::vector<double>& x, const std::vector<double>& y) {
  const double count = static_cast<double>(x.size());
  const double x_mean = std::accumulate(x.begin(), x.end(), 0.0) / count;
  const double y_mean = std::accumulate(y.begin(), y.end(), 0.0) / count;
  double xx = 0, xy = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    xx += (x[k] - x_mean) * (x[k] - x_mean);
    xy += (x[k] - x_mean) * (y[k] - y_mean);
  }
  return xx > 0 ? std::max(0.0, xy / xx) : 0;
}

double mean_of(const std::vector<double>& values) {
  return values.empty() ? 0 : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// A mean for every centre of what the frames nearest to it have. The mean of all counts as one frame more.
std::vector<double> means_at(const std::vector<std::size_t>& closest, const std::vector<double>& values,
                             std::size_t centres) {
  const double mean = mean_of(values);
  std::vector<double> sums(centres, mean), counts(centres, 1);
  for (std::size_t k = 0; k < closest.size(); ++k) {
    sums[closest[k]] += values[k];
    counts[closest[k]] += 1;
  }
  for (std::size_t m = 0; m < centres; ++m) sums[m] /= counts[m];
  return centres > 0 ? sums : std::vector<double>{mean};
}

// Positions of the values in ascending order; equal values share the mean of theirs.
std::vector<double> ranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> result(values.size());
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && values[order[end]] == values[order[begin]]) ++end;
    for (std::size_t k = begin; k < end; ++k) result[order[k]] = 0.5 * static_cast<double>(begin + end - 1);
  }
  return result;
}

}  // namespace

ErrorModel calibrate(const RegressionData& data, const Regression& regression, const std::vector<double>& left,
                     const std::vector<double>& motions) {
  const std::size_t centres = regression.centre_frames.size();
  std::vector<double> nearest, errors, moved;
  std::vector<std::size_t> closest;
  for (std::size_t n = 0; n < data.folds.size(); ++n) {
    if (data.folds[n] < 0) continue;
    const Eigen::RowVectorXd coordinates = data.features.row(static_cast<Index>(n));
    double of_others = (coordinates - data.rest).squaredNorm(), of_all = std::numeric_limits<double>::infinity();
    std::size_t own = 0;
    for (std::size_t m = 0; m < centres; ++m) {
      const double distance = (coordinates - regression.centres.row(static_cast<Index>(m))).squaredNorm();
      if (distance < of_all) {
        of_all = distance;
        own = m;
      }
      const int frame = regression.centre_frames[m];
      const bool same_fold = frame >= 0 && data.folds[static_cast<std::size_t>(frame)] == data.folds[n];
      if (!same_fold) of_others = std::min(of_others, distance);
    }
    nearest.push_back(of_others);
    errors.push_back(left[n]);
    moved.push_back(motions[n]);
    if (centres > 0) closest.push_back(own);
  }
  ErrorModel model;
  model.usual = mean_of(nearest);
  // Never nothing: ten times as far away, in squares, the error has at least doubled.
  const double least = model.usual > 0 ? 0.1 * mean_of(errors) / model.usual : 0;
  model.growth = nearest.empty() ? 0 : std::max(least, growth(nearest, errors));
  model.local = means_at(closest, errors, centres);
  model.motion = means_at(closest, moved, centres);
  return model;
}

void append_region(const std::string& name, const std::vector<std::uint32_t>& joints, double size,
                   const ErrorModel& model, CoverageTable& coverage) {
  const auto append_rms = [&](const std::vector<double>& energies, std::vector<float>& to) {
    for (const double energy : energies) to.push_back(static_cast<float>(std::sqrt(energy / size)));
  };
  coverage.names.push_back(name);
  coverage.joints.insert(coverage.joints.end(), joints.begin(), joints.end());
  coverage.joint_begin.push_back(static_cast<std::uint32_t>(coverage.joints.size()));
  coverage.sizes.push_back(static_cast<float>(size));
  coverage.growth.push_back(static_cast<float>(model.growth));
  coverage.usual.push_back(static_cast<float>(model.usual));
  append_rms(model.local, coverage.local);
  append_rms(model.motion, coverage.motion);
}

std::vector<ExpectedError> expected_errors(const Basis& basis, const std::vector<Pose>& poses) {
  const ErrorExpectation expectation(basis);
  std::vector<ExpectedError> results(poses.size());
  Progress progress("coverage", poses.size());
  parallel_for(poses.size(), [&](std::size_t n) {
    results[n] = expectation.of(poses[n], measure_strains(basis, poses[n]));
    progress.advance();
  });
  return results;
}

std::vector<ExpectedError> expected_errors(const ErrorExpectation& expectation, std::span<const Pose> poses,
                                           std::span<const float> strains) {
  std::vector<ExpectedError> results(poses.size());
  const std::size_t fibres = strains.size() / std::max<std::size_t>(1, poses.size());
  parallel_for(poses.size(),
               [&](std::size_t n) { results[n] = expectation.of(poses[n], strains.subspan(n * fibres, fibres)); });
  return results;
}

double root_mean_square(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0 : std::sqrt(sum / static_cast<double>(values.size()));
}

double rank_correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const std::vector<double> x = ranks(a), y = ranks(b);
  const double middle = 0.5 * (static_cast<double>(a.size()) - 1);
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    xx += (x[k] - middle) * (x[k] - middle);
    xy += (x[k] - middle) * (y[k] - middle);
    yy += (y[k] - middle) * (y[k] - middle);
  }
  return xy / std::sqrt(xx * yy);
}

std::size_t spreading_gap(std::size_t frames, std::size_t count) {
  return std::max<std::size_t>(2, frames / (4 * count));
}

std::vector<std::size_t> worth_simulating(const std::vector<double>& expected, std::size_t count, std::size_t gap) {
  std::vector<std::size_t> order(expected.size()), chosen;
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return expected[a] > expected[b]; });
  for (const std::size_t frame : order) {
    if (chosen.size() == count) break;
    const bool near = std::any_of(chosen.begin(), chosen.end(), [&](std::size_t other) {
      return std::max(frame, other) - std::min(frame, other) < gap;
    });
    if (!near) chosen.push_back(frame);
  }
  return chosen;
}

}  // namespace bodyopt
