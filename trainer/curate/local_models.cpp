#include "trainer/curate/local_models.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "base/parallel.h"
#include "trainer/curate/pose_space.h"

namespace bodyopt {
namespace {

using Eigen::Index;

constexpr std::size_t kMostNeighbours = 48;
constexpr double kAnchor = 10;
// On the slopes, in units of the neighbourhood's size: directions that the neighbours do not span stay flat.
constexpr double kSlopePenalty = 1e-3;

struct Neighbour {
  std::size_t frame = 0;
  Eigen::VectorXd difference;  // as a part of the reach
  double distance = 0;
  int pass = 0;
};

// 1 at 0, 0 from 1 on (Tukey's biweight).
double nearness(double distance) {
  const double left = 1 - distance * distance;
  return left > 0 ? left * left : 0;
}

// Numbers those that follow each other in one take alike. `near`: by rising frame.
void number_passes(const PoseDatabase& database, std::vector<Neighbour>& near) {
  for (std::size_t k = 1; k < near.size(); ++k) {
    const bool follows = near[k].frame - near[k - 1].frame <= 2 &&
                         database.frames[near[k].frame].take == database.frames[near[k - 1].frame].take;
    near[k].pass = near[k - 1].pass + (follows ? 0 : 1);
  }
}

std::vector<Neighbour> neighbours_of(const PoseDatabase& database, const SkinPart& part, std::size_t frame,
                                     double reach, const std::vector<char>& used) {
  std::vector<Neighbour> near;
  for (std::size_t n = 0; n < database.frames.size(); ++n) {
    if (!used[n] || !is_near(database.frames[frame].pose, database.frames[n].pose, part.joints, 1.001 * reach))
      continue;
    Neighbour other{n, pose_difference(database.frames[frame].pose, database.frames[n].pose, part.joints) / reach};
    other.distance = other.difference.norm();
    if (other.distance < 1) near.push_back(std::move(other));
  }
  number_passes(database, near);
  return near;
}

// A pass weighs what its nearest frame does, shared among its frames.
std::vector<double> weights_of(const std::vector<Neighbour>& near, const std::vector<char>& anchors) {
  std::map<int, std::pair<double, double>> passes;  // largest, sum
  std::vector<double> weights;
  for (const Neighbour& other : near) {
    weights.push_back(nearness(other.distance) * (anchors[other.frame] ? kAnchor : 1));
    auto& [largest, sum] = passes[other.pass];
    largest = std::max(largest, weights.back());
    sum += weights.back();
  }
  for (std::size_t k = 0; k < near.size(); ++k) {
    const auto& [largest, sum] = passes[near[k].pass];
    if (sum > 0) weights[k] *= largest / sum;
  }
  return weights;
}

std::vector<FrameShare> fit(const std::vector<Neighbour>& near, const std::vector<double>& weights) {
  const Index count = static_cast<Index>(near.size()), features = near.front().difference.size();
  Eigen::MatrixXd rows(count, features + 1);
  Eigen::VectorXd weight(count);
  for (Index k = 0; k < count; ++k) {
    rows(k, 0) = 1;
    rows.row(k).tail(features) = near[static_cast<std::size_t>(k)].difference.transpose();
    weight[k] = weights[static_cast<std::size_t>(k)];
  }
  Eigen::MatrixXd normal = rows.transpose() * weight.asDiagonal() * rows;
  normal.diagonal().tail(features).array() += kSlopePenalty * weight.sum();
  const Eigen::VectorXd first = normal.ldlt().solve(Eigen::VectorXd::Unit(features + 1, 0));
  const Eigen::VectorXd shares = weight.asDiagonal() * (rows * first);
  std::vector<FrameShare> result;
  for (Index k = 0; k < count; ++k) result.push_back({near[static_cast<std::size_t>(k)].frame, shares[k]});
  return result;
}

}  // namespace

std::vector<SkinPart> skin_parts(const PoseDatabase& database) {
  const Character& character = database.character;
  const Eigen::Index vertices = character.vertices.rows();
  std::vector<RegionWeights> regions = database.regions;
  if (regions.empty() || sum_of_weights(regions, vertices).minCoeff() < 0.99) {
    regions.assign(character.skeleton.size(), {});
    for (std::size_t j = 0; j < regions.size(); ++j) regions[j].name = character.skeleton.joints[j].name;
    for (std::uint32_t v = 0; v < character.weights.size(); ++v) {
      for (const JointWeight& weight : character.weights[v]) {
        regions[weight.joint].vertices.push_back(v);
        regions[weight.joint].weights.push_back(weight.weight);
      }
    }
  }
  std::vector<SkinPart> parts;
  for (RegionWeights& region : regions) {
    if (region.vertices.empty()) continue;
    Eigen::VectorXd mask = Eigen::VectorXd::Zero(vertices);
    for (std::size_t k = 0; k < region.vertices.size(); ++k) mask[Index{region.vertices[k]}] = region.weights[k];
    parts.push_back({std::move(region), joints_moving(character, mask)});
  }
  return parts;
}

LocalModels local_models(const PoseDatabase& database, const SkinPart& part, double degrees,
                         const std::vector<char>& used, const std::vector<char>& anchors) {
  const double reach = degrees * std::numbers::pi / 180;
  LocalModels models;
  models.shares.resize(database.frames.size());
  models.others.resize(database.frames.size());
  models.neighbours.resize(database.frames.size(), 0);
  parallel_for(database.frames.size(), [&](std::size_t n) {
    if (!used[n]) return;
    std::vector<Neighbour> near = neighbours_of(database, part, n, reach, used);
    models.neighbours[n] = static_cast<int>(near.size());
    if (near.back().pass == 0) return;
    const auto own = std::find_if(near.begin(), near.end(), [n](const Neighbour& k) { return k.frame == n; });
    const int own_pass = own->pass;
    std::stable_sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.distance < b.distance; });
    if (near.size() > kMostNeighbours) near.resize(kMostNeighbours);
    for (const Neighbour& other : near) {
      if (other.pass != own_pass) models.others[n].push_back(other.frame);
    }
    if (!models.others[n].empty()) models.shares[n] = fit(near, weights_of(near, anchors));
  });
  return models;
}

}  // namespace bodyopt
