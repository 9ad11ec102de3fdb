#include "trainer/train/data/data_warnings.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "base/wording.h"
#include "runtime/core/text.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;

// Deviations by which features of one pose may differ: what lies so near differs by rounding.
constexpr double kSame = 1e-3;
// Distances that the pose may explain: a part of the character's size, and of the region's motion.
constexpr double kPlausibleOfSize = 1.0 / 900, kPlausibleOfMotion = 0.05;

// Any direction in which frames that differ hardly ever coincide.
Eigen::VectorXd some_direction(Index count) {
  return Eigen::VectorXd::NullaryExpr(count, [](Index k) { return std::cos(1.7 * static_cast<double>(k)); });
}

// Root mean square over the region of a displacement.
double size_in(const RegionWeights& region, const Eigen::RowVectorXf& row) {
  const auto square = [&](std::size_t k) {
    return double{row.segment<3>(3 * Index{region.vertices[k]}).squaredNorm()};
  };
  return std::sqrt(mean_over(region, square));
}

// Sentences of one kind; the rest is counted.
constexpr std::size_t kShown = 5;

std::string millimetres(double metres) { return formatted("%.1f mm", 1e3 * metres); }

template <typename Found>
void worst_first(std::vector<Found>& found) {
  std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) { return a.distance > b.distance; });
}

}  // namespace

std::vector<FramePair> frames_of_one_pose(const Eigen::MatrixXd& features) {
  // Frames are compared with those beside them along one direction only.
  const Eigen::VectorXd direction = some_direction(features.cols());
  const Eigen::VectorXd along = features * direction;
  const double reach = kSame * direction.cwiseAbs().sum();
  const Eigen::MatrixXd columns = features.transpose();
  std::vector<Index> order(static_cast<std::size_t>(features.rows()));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return along[a] < along[b]; });

  std::vector<std::vector<Index>> poses;  // frames of each; the first one found stands for it
  for (const Index frame : order) {
    auto pose = poses.rbegin();
    while (pose != poses.rend() && along[frame] - along[pose->front()] <= reach &&
           !((columns.col(frame) - columns.col(pose->front())).array().abs() <= kSame).all()) {
      ++pose;
    }
    if (pose != poses.rend() && along[frame] - along[pose->front()] <= reach) {
      pose->push_back(frame);
    } else {
      poses.push_back({frame});
    }
  }

  std::vector<FramePair> pairs;
  for (const std::vector<Index>& pose : poses) {
    const Index first = *std::min_element(pose.begin(), pose.end());
    for (const Index frame : pose) {
      if (frame != first) pairs.push_back({static_cast<std::size_t>(first), static_cast<std::size_t>(frame)});
    }
  }
  std::ranges::sort(pairs, {}, &FramePair::second);
  return pairs;
}

std::vector<Contradiction> contradictions(const std::vector<FramePair>& pairs, const Displacements& displacements,
                                          const RegionWeights& region, double size, double motion) {
  std::vector<Contradiction> found;
  const double plausible = std::max(kPlausibleOfSize * size, kPlausibleOfMotion * motion);
  for (const FramePair& pair : pairs) {
    const Eigen::RowVectorXf difference =
        displacements.row(static_cast<Index>(pair.first)) - displacements.row(static_cast<Index>(pair.second));
    const double distance = size_in(region, difference);
    if (distance > plausible) found.push_back({pair, distance, region.name});
  }
  return found;
}

std::vector<std::string> contradiction_warnings(const SampleSet& set, std::vector<Contradiction> contradictions) {
  worst_first(contradictions);
  std::vector<std::string> warnings;
  std::set<std::pair<std::size_t, std::size_t>> pairs;
  for (const auto& [frames, distance, region] : contradictions) {
    if (!pairs.emplace(frames.first, frames.second).second || pairs.size() > kShown) continue;
    const Sample &first = set.train[frames.first], &second = set.train[frames.second];
    warnings.push_back(frame_name(set, first) + " and " + frame_name(set, second) +
                       " have the same pose and controls, but their shapes are " + millimetres(distance) +
                       " RMS apart in region '" + region +
                       "': one of them may have been made with another muscles file or other materials, or as a draft");
  }
  if (pairs.size() > kShown) {
    warnings.push_back(count_of(pairs.size() - kShown, "more pair", "more pairs") +
                       " of frames of the same pose and controls have shapes that contradict each other");
  }
  return warnings;
}

std::vector<std::string> outlier_warnings(const SampleSet& set, const std::vector<std::uint32_t>& order,
                                          std::vector<OutlierVertex> outliers) {
  worst_first(outliers);
  std::vector<std::string> warnings;
  for (const OutlierVertex& outlier : outliers) {
    if (warnings.size() == kShown) break;
    warnings.push_back(frame_name(set, set.train[outlier.frame]) + ": vertex " +
                       std::to_string(set.character.first_output(order[outlier.vertex])) + " is " +
                       millimetres(outlier.distance) +
                       " from where its neighbours take it: it was trained as if it moved with them");
  }
  if (outliers.size() > kShown) {
    warnings.push_back(count_of(outliers.size() - kShown, "more vertex", "more vertices") +
                       " of single frames flew away from their neighbours");
  }
  return warnings;
}

std::vector<std::string> constant_control_warnings(const SampleSet& set) {
  std::vector<std::string> warnings;
  for (std::size_t k = 0; k < set.controls.size(); ++k) {
    const float value = set.train.front().pose.controls[k];
    const auto same = [&](const Sample& sample) { return sample.pose.controls[k] == value; };
    if (!std::all_of(set.train.begin(), set.train.end(), same)) continue;
    warnings.push_back("control '" + set.controls[k] + "' is " + formatted("%g", double{value}) +
                       " in every training frame: what it does cannot be learned");
  }
  return warnings;
}

std::vector<std::string> few_frames_warnings(const SampleSet& set, std::size_t features) {
  if (set.train.size() >= features) return {};
  return {std::to_string(set.train.size()) + " training frames for " + std::to_string(features) +
          " features that vary: trust the basis near these frames only, or simulate more"};
}

}  // namespace bodyopt::trainer
