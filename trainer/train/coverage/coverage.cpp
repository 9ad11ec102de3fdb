#include "trainer/train/coverage/coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "base/progress.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;

// Of all motion, that the error may grow by at twice the usual distance.
constexpr double kShares[] = {0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1};

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

// A mean for every centre of what the frames nearest to it have, and of `own`, which counts as one frame more.
std::vector<double> means_at(const std::vector<std::size_t>& closest, const std::vector<double>& values,
                             const std::vector<double>& own) {
  std::vector<double> sums = own, counts(own.size(), 1);
  for (std::size_t k = 0; k < closest.size(); ++k) {
    sums[closest[k]] += values[k];
    counts[closest[k]] += 1;
  }
  for (std::size_t m = 0; m < sums.size(); ++m) sums[m] /= counts[m];
  return sums;
}

// A frame as the fit without its fold sees it.
struct HeldOutFrame {
  std::size_t number = 0, closest = 0, closest_other = 0;  // of centres: of all, and of those of other folds
  double to_others = 0;                                    // square, to the nearest of the latter
};

std::vector<HeldOutFrame> held_out_frames(const HeldOutError& error) {
  const RegressionData& data = error.data;
  std::vector<HeldOutFrame> frames;
  for (std::size_t n = 0; n < data.folds.size(); ++n) {
    if (data.folds[n] < 0) continue;
    const Eigen::RowVectorXd coordinates = data.features.row(static_cast<Index>(n));
    HeldOutFrame frame{.number = n, .to_others = (coordinates - data.rest).squaredNorm()};
    double to_all = std::numeric_limits<double>::infinity();
    for (std::size_t m = 0; m < error.regression.centre_frames.size(); ++m) {
      const double distance = (coordinates - error.regression.centres.row(static_cast<Index>(m))).squaredNorm();
      if (distance < to_all) {
        to_all = distance;
        frame.closest = m;
      }
      const int of = error.regression.centre_frames[m];
      const bool same_fold = of >= 0 && data.folds[static_cast<std::size_t>(of)] == data.folds[n];
      if (same_fold || distance > frame.to_others) continue;
      frame.to_others = distance;
      frame.closest_other = m;
    }
    frames.push_back(frame);
  }
  return frames;
}

// Square metres per squared unit of a coordinate: by this share of all motion at twice the usual distance. Never
// nothing: ten times as far away, in squares, the error has at least doubled.
double growth_of(double share, const ErrorModel& model) {
  const double energy = std::max(share * mean_of(model.motion), 0.1 * mean_of(model.local));
  return model.usual > 0 ? energy / model.usual : 0;
}

// Of each take, what is expected and what was left, square metres.
struct TakeEnergies {
  double expected = 0, left = 0;
};

std::map<int, TakeEnergies> energies_of_takes(const std::vector<std::vector<LeftOutFrame>>& regions,
                                              const std::vector<ErrorModel>& models, double share) {
  std::map<int, TakeEnergies> takes;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const double growth = growth_of(share, models[r]);
    for (const LeftOutFrame& frame : regions[r]) {
      TakeEnergies& energies = takes[frame.take];
      energies.expected += std::min(frame.local + growth * frame.further, frame.motion);
      energies.left += frame.left;
    }
  }
  return takes;
}

// Takes of half of the frames at most.
std::set<int> minor_takes(const std::vector<LeftOutFrame>& frames) {
  std::map<int, std::size_t> counts;
  for (const LeftOutFrame& frame : frames) ++counts[frame.take];
  std::set<int> minor;
  for (const auto& [take, count] : counts) {
    if (counts.size() > 1 && 2 * count <= frames.size()) minor.insert(take);
  }
  return minor;
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

ErrorModel calibrate(const HeldOutError& error, const std::vector<double>& motions) {
  const std::vector<HeldOutFrame> frames = held_out_frames(error);
  std::vector<double> distances, errors, moved;
  std::vector<std::size_t> closest;
  for (const HeldOutFrame& frame : frames) {
    distances.push_back(frame.to_others);
    errors.push_back(error.left[frame.number]);
    moved.push_back(motions[frame.number]);
    closest.push_back(frame.closest);
  }
  ErrorModel model;
  model.usual = mean_of(distances);
  // A centre knows how far its own frame moves; the rest pose does not move. The first guess is that as large a part of
  // it is left as of all motion.
  std::vector<double> own;
  for (const int frame : error.regression.centre_frames) {
    own.push_back(frame < 0 ? 0 : motions[static_cast<std::size_t>(frame)]);
  }
  if (own.empty()) own.push_back(mean_of(moved));
  model.motion = means_at(closest, moved, own);
  const double share = mean_of(moved) > 0 ? mean_of(errors) / mean_of(moved) : 0;
  own = model.motion;
  for (double& guess : own) guess *= share;
  model.local = means_at(closest, errors, own);
  if (!frames.empty()) model.growth = std::max(growth_of(0, model), growth(distances, errors));
  return model;
}

std::vector<LeftOutFrame> left_out_frames(const HeldOutError& error, const ErrorModel& model) {
  std::vector<LeftOutFrame> frames;
  for (const HeldOutFrame& frame : held_out_frames(error)) {
    frames.push_back({error.data.folds[frame.number], error.left[frame.number], model.local[frame.closest_other],
                      model.motion[frame.closest_other], std::max(0.0, frame.to_others - model.usual)});
  }
  return frames;
}

void grow_by_takes(const std::vector<std::vector<LeftOutFrame>>& regions, std::vector<ErrorModel>& models) {
  const std::set<int> asked = regions.empty() ? std::set<int>{} : minor_takes(regions.front());
  double least = std::numeric_limits<double>::infinity();
  std::optional<double> best;
  for (const double share : kShares) {
    double off = 0;
    for (const auto& [take, energies] : energies_of_takes(regions, models, share)) {
      if (!asked.contains(take) || !(energies.left > 0)) continue;
      const double ratio = std::sqrt(energies.expected / energies.left);
      off += ratio + 1 / ratio;
    }
    if (!(off > 0 && off < least)) continue;
    least = off;
    best = share;
  }
  if (!best) return;
  for (ErrorModel& model : models) model.growth = growth_of(*best, model);
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
  constexpr std::size_t kFramesAtOnce = 64;  // whose skins are held in memory
  const ErrorExpectation expectation(basis);
  Basis learned = basis;
  learned.modifiers = {};  // they take time, and no error is expected of them
  Deformer deformer(std::move(learned), {.name = "cpu"});
  deformer.set_normals(false);
  std::vector<ExpectedError> errors;
  Progress progress("coverage", poses.size());
  while (errors.size() < poses.size()) {
    const std::size_t begin = errors.size(), count = std::min(poses.size() - begin, kFramesAtOnce);
    std::vector<Pose> part;
    for (std::size_t k = begin; k < begin + count; ++k) part.push_back({poses[k].own_joints(), poses[k].controls});
    const Evaluation evaluation = deformer.evaluate(part);
    for (std::size_t k = 0; k < count; ++k) errors.push_back(expectation.of(evaluation, k));
    progress.advance(count);
  }
  return errors;
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

}  // namespace bodyopt::trainer
