#include "trainer/train/coverage/coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "base/parallel.h"
#include "base/progress.h"
#include "runtime/core/error.h"
#include "runtime/core/half.h"
#include "runtime/core/strict_json.h"
#include "runtime/cpu/kernels.h"
#include "runtime/host/fade.h"
#include "runtime/host/rig.h"
#include "trainer/train/features/features.h"

namespace bodyopt {
namespace {

using Eigen::Index;

// Blended between centres by the inverse of the squared distance, squared: each centre's own value at the centre.
class Blend {
 public:
  void add(double squared_distance, double value) {
    const double weight = 1 / (squared_distance * squared_distance + 1e-12);
    sum_ += weight * value;
    weight_ += weight;
  }
  double value() const { return weight_ > 0 ? sum_ / weight_ : 0; }

 private:
  double sum_ = 0, weight_ = 0;
};

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

// A mean for every centre of what the frames nearest to it have. The mean of all counts as one frame more: a single
// frame says little.
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
  model.distance = nearest.empty() ? 0 : std::max(least, growth(nearest, errors));
  model.local = means_at(closest, errors, centres);
  model.motion = means_at(closest, moved, centres);
  return model;
}

namespace {

// Root mean square per vertex, to the micrometre: numbers of a few digits.
std::vector<double> in_mm(const std::vector<double>& energies, double size) {
  std::vector<double> result;
  for (const double energy : energies) result.push_back(std::round(1e6 * std::sqrt(energy / size)) / 1e3);
  return result;
}

// And back.
std::vector<double> from_mm(const std::vector<double>& values, double size) {
  std::vector<double> energies;
  for (const double mm : values) energies.push_back(size * mm * mm * 1e-6);
  return energies;
}

}  // namespace

std::string coverage_text(const std::vector<RegionCoverage>& regions) {
  nlohmann::json list = nlohmann::json::array();
  for (const RegionCoverage& region : regions) {
    list.push_back({{"name", region.name},
                    {"joints", region.joints},
                    {"size", region.size},
                    {"distance_m2", region.expected.distance},
                    {"usual", region.expected.usual},
                    {"local_mm", in_mm(region.expected.local, region.size)},
                    {"motion_mm", in_mm(region.expected.motion, region.size)}});
  }
  return list.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

bool has_coverage(const Basis& basis) { return basis.metadata.contains("coverage"); }

std::vector<RegionCoverage> read_coverage(const Basis& basis) {
  const auto text = basis.metadata.find("coverage");
  if (text == basis.metadata.end()) {
    throw Error(ErrorKind::mismatch, "the basis does not say how well it covers poses: it was trained without shapes");
  }
  const std::string where = "the basis' metadata 'coverage'";
  const auto list = parse_strict_json<nlohmann::json>(text->second, where);
  std::vector<RegionCoverage> regions;
  try {
    for (const auto& entry : list) {
      RegionCoverage& region = regions.emplace_back();
      region.joints = entry.at("joints").get<std::vector<std::string>>();
      region.name = entry.value("name", region.joints.empty() ? "" : region.joints.front());
      region.size = entry.at("size").get<double>();
      region.expected.distance = entry.at("distance_m2").get<double>();
      region.expected.usual = entry.at("usual").get<double>();
      region.expected.metric = entry.value("metric", std::vector<double>());
      region.expected.local = from_mm(entry.at("local_mm").get<std::vector<double>>(), region.size);
      region.expected.motion = from_mm(entry.value("motion_mm", std::vector<double>()), region.size);
    }
  } catch (const nlohmann::json::exception& error) {
    throw Error(ErrorKind::file, where + " is damaged: " + error.what());
  }
  if (regions.size() != basis.residual.regions.size()) {
    throw Error(ErrorKind::file, where + " tells of " + std::to_string(regions.size()) + " regions, the basis has " +
                                     std::to_string(basis.residual.regions.size()));
  }
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const ErrorModel& expected = regions[r].expected;
    const std::size_t centres = std::max<std::size_t>(1, basis.residual.regions[r].centre_count);
    const bool known = std::all_of(regions[r].joints.begin(), regions[r].joints.end(),
                                   [&](const std::string& name) { return basis.skeleton.find(name) >= 0; });
    const auto fits = [](const std::vector<double>& values, std::size_t count) {
      return values.empty() || values.size() == count;
    };
    if (known && !regions[r].joints.empty() && regions[r].size > 0 && expected.distance >= 0 &&
        expected.local.size() == centres && fits(expected.motion, centres) &&
        fits(expected.metric, basis.residual.regions[r].coordinate_count)) {
      continue;
    }
    throw Error(ErrorKind::file, where + ", region " + std::to_string(r) +
                                     ": expected joints of the skeleton, a positive size, an error and a motion for "
                                     "each of its " +
                                     std::to_string(centres) + " centres and a number for each of its coordinates");
  }
  return regions;
}

namespace {

// What the residual knows of a pose.
struct PoseFeatures {
  std::vector<float> coordinates, excess;  // of all regions; of all features
  std::vector<float> fades;                // of all regions
};

PoseFeatures features_of(const Basis& basis, const Pose& pose) {
  const ResidualTable& residual = basis.residual;
  PoseFeatures features{
      std::vector<float>(residual.coordinate_count()), std::vector<float>(residual.feature_count()), {}};
  std::vector<float> controls = pose.controls, inside(residual.feature_count());
  controls.resize(residual.controls.size(), 0.0f);
  const std::vector<float> joint_features = pose_rig(basis.skeleton, pose).joint_features;
  cpu::residual_features(residual.features, joint_features, measure_strains(basis, pose), controls, 1, inside,
                         features.excess);
  cpu::residual_project(residual, inside, 1, features.coordinates);
  features.fades = region_fades(residual, joint_features);
  return features;
}

// Features that a region listens to, and those of the joints that move its skin: some never moved in training, and so
// are none that it could listen to.
std::set<std::uint32_t> watched_features(const Basis& basis, const Region& region, const RegionCoverage& coverage) {
  const auto first = basis.residual.region_features.begin() + region.feature_begin;
  std::set<std::uint32_t> watched(first, first + region.feature_count);
  const std::vector<std::uint32_t> joints = feature_joints(basis.skeleton);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const std::string& name = basis.skeleton.joints[joints[j]].name;
    if (std::find(coverage.joints.begin(), coverage.joints.end(), name) == coverage.joints.end()) continue;
    for (std::uint32_t k = 0; k < 9; ++k) watched.insert(9 * static_cast<std::uint32_t>(j) + k);
  }
  return watched;
}

// Square metres.
double expected_energy(const ResidualTable& residual, std::size_t r, const ErrorModel& expected,
                       const std::set<std::uint32_t>& watched, const PoseFeatures& features) {
  const Region& region = residual.regions[r];
  double outside = 0;
  for (const std::uint32_t f : watched) outside += double{features.excess[f]} * double{features.excess[f]};
  double nearest = std::numeric_limits<double>::infinity();
  Blend local, motion;
  for (std::uint32_t m = 0; m < std::max(1u, region.centre_count); ++m) {
    const std::uint32_t* centre =
        residual.centres.data() + region.centre_values + m * ((region.coordinate_count + 1) / 2);
    double distance = 0;
    for (std::uint32_t k = 0; m < region.centre_count && k < region.coordinate_count; ++k) {
      const double difference =
          double{features.coordinates[region.coordinate_begin + k]} - double{half_low(centre[k / 2] >> 16 * (k % 2))};
      distance += (expected.metric.empty() ? 1 : expected.metric[k]) * difference * difference;
    }
    nearest = std::min(nearest, distance);
    local.add(distance, expected.local[m]);
    if (!expected.motion.empty()) motion.add(distance, expected.motion[m]);
  }
  const double further = region.centre_count == 0 ? outside : std::max(0.0, nearest + outside - expected.usual);
  const double learned = local.value() + expected.distance * further;
  if (expected.motion.empty()) return learned;
  const double fade{features.fades[r]};
  return fade * std::min(learned, motion.value()) + (1 - fade) * motion.value();
}

using Watched = std::vector<std::set<std::uint32_t>>;  // per region

Watched watched_features(const Basis& basis, const std::vector<RegionCoverage>& regions) {
  Watched watched;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    watched.push_back(watched_features(basis, basis.residual.regions[r], regions[r]));
  }
  return watched;
}

ExpectedError expected_error(const Basis& basis, const std::vector<RegionCoverage>& regions, const Watched& watched,
                             const Pose& pose) {
  const PoseFeatures features = features_of(basis, pose);
  ExpectedError result;
  double sum = 0;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const double energy = expected_energy(basis.residual, r, regions[r].expected, watched[r], features);
    sum += energy;
    result.region_mm.push_back(1e3 * std::sqrt(energy / regions[r].size));
  }
  result.rms_mm = 1e3 * std::sqrt(sum / basis.mesh.vertex_count());
  return result;
}

}  // namespace

ExpectedError expected_error(const Basis& basis, const std::vector<RegionCoverage>& regions, const Pose& pose) {
  return expected_error(basis, regions, watched_features(basis, regions), pose);
}

std::vector<ExpectedError> expected_errors(const Basis& basis, const std::vector<RegionCoverage>& regions,
                                           const std::vector<Pose>& poses) {
  const Watched watched = watched_features(basis, regions);
  std::vector<ExpectedError> results(poses.size());
  Progress progress("coverage", poses.size());
  parallel_for(poses.size(), [&](std::size_t n) {
    results[n] = expected_error(basis, regions, watched, poses[n]);
    progress.advance();
  });
  return results;
}

namespace {

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
