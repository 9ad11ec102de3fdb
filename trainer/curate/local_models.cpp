#include "trainer/curate/local_models.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "base/parallel.h"
#include "trainer/curate/pose_space.h"

namespace bodyopt {
namespace {

using Eigen::Index;

constexpr std::size_t kMostNeighbours = 48, kMostOfPass = 8;
constexpr double kAnchor = 10;
// On slopes, per weight of the neighbours and in units of the reach, and on what a pass is off by: passes that lie
// closer together than about a third of the reach disagree, those further apart may differ by a slope.
constexpr double kSlopePenalty = 5e-5, kPassPenalty = 0.005;
// What a pass is off by, told from others at its side, is a difference of means: the shares of these add up to 2 at
// most, signs apart. More is told from slopes, drawn out beyond the frames that show them.
constexpr double kMostLeverage = 2;
constexpr double kLeastStep = 0.1 * std::numbers::pi / 180;  // radians: shorter ones have no direction of their own

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

// Whether a frame of the database follows the one before it in its take.
bool follows(const PoseDatabase& database, std::size_t before, std::size_t frame) {
  return frame - before <= 2 && database.frames[frame].take == database.frames[before].take;
}

// Of every frame: stretches of a take that go one way. Where one turns back the next begins; what led to the turn is
// what it has of history.
std::vector<int> stretches_of(const PoseDatabase& database, const SkinPart& part) {
  std::vector<int> stretches(database.frames.size(), 0);
  Eigen::VectorXd last_step;
  for (std::size_t n = 1; n < stretches.size(); ++n) {
    const bool goes_on = follows(database, n - 1, n);
    const Eigen::VectorXd step = pose_difference(database.frames[n - 1].pose, database.frames[n].pose, part.joints);
    const bool moves = goes_on && step.norm() > kLeastStep;
    const bool turns = moves && last_step.size() > 0 && step.dot(last_step) < 0;
    stretches[n] = stretches[n - 1] + (goes_on && !turns ? 0 : 1);
    if (!goes_on) last_step.resize(0);
    if (moves) last_step = step;
  }
  return stretches;
}

// Numbers alike what is of one stretch and was not away in between. `near`: by rising frame.
void number_passes(const PoseDatabase& database, const std::vector<int>& stretches, std::vector<Neighbour>& near) {
  for (std::size_t k = 1; k < near.size(); ++k) {
    const std::size_t before = near[k - 1].frame, frame = near[k].frame;
    const bool same = follows(database, before, frame) && stretches[before] == stretches[frame];
    near[k].pass = near[k - 1].pass + (same ? 0 : 1);
  }
}

std::vector<Neighbour> neighbours_of(const PoseDatabase& database, const SkinPart& part, std::size_t frame,
                                     double reach, const std::vector<int>& stretches, const std::vector<char>& used) {
  std::vector<Neighbour> near;
  for (std::size_t n = 0; n < database.frames.size(); ++n) {
    if (!used[n] || !is_near(database.frames[frame].pose, database.frames[n].pose, part.joints, 1.001 * reach))
      continue;
    Neighbour other{n, pose_difference(database.frames[frame].pose, database.frames[n].pose, part.joints) / reach};
    other.distance = other.difference.norm();
    if (other.distance < 1) near.push_back(std::move(other));
  }
  number_passes(database, stretches, near);
  return near;
}

// The nearest, of every pass a few. `near`: by rising distance.
void keep_nearest(std::vector<Neighbour>& near) {
  std::map<int, std::size_t> kept;
  std::erase_if(near, [&](const Neighbour& other) { return ++kept[other.pass] > kMostOfPass; });
  if (near.size() > kMostNeighbours) near.resize(kMostNeighbours);
}

// A column for every pass, and how much weighs against its being off: more if it stays. All passes weigh alike, however
// many frames they have; one that comes barely near has little weight to begin with.
std::map<int, std::pair<Index, double>> pass_columns(const std::vector<Neighbour>& near, Index first,
                                                     const std::vector<char>& anchors) {
  std::map<int, std::pair<Index, double>> columns;
  for (const Neighbour& other : near) {
    const Index next = first + static_cast<Index>(columns.size());
    auto& [column, penalty] = columns.try_emplace(other.pass, next, 0.0).first->second;
    const double weight = kPassPenalty * (anchors[other.frame] ? kAnchor : 1);
    penalty = std::max(penalty, weight);
  }
  return columns;
}

// What of the shapes of the neighbours adds up to what their pass `own` is off by.
std::vector<FrameShare> fit(const std::vector<Neighbour>& near, int own, const std::vector<char>& anchors) {
  const Index count = static_cast<Index>(near.size()), features = near.front().difference.size();
  const std::map<int, std::pair<Index, double>> passes = pass_columns(near, features + 1, anchors);
  const Index columns = features + 1 + static_cast<Index>(passes.size());
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(count, columns);
  Eigen::VectorXd weight(count), penalty = Eigen::VectorXd::Zero(columns);
  for (Index k = 0; k < count; ++k) {
    const Neighbour& other = near[static_cast<std::size_t>(k)];
    rows(k, 0) = 1;
    rows.row(k).segment(1, features) = other.difference.transpose();
    rows(k, passes.at(other.pass).first) = 1;
    weight[k] = nearness(other.distance);
  }
  penalty.segment(1, features).setConstant(kSlopePenalty * weight.sum());
  for (const auto& [pass, column] : passes) penalty[column.first] = column.second;
  Eigen::MatrixXd normal = rows.transpose() * weight.asDiagonal() * rows;
  normal.diagonal() += penalty;
  const Eigen::VectorXd wanted = normal.ldlt().solve(Eigen::VectorXd::Unit(columns, passes.at(own).first));
  Eigen::VectorXd shares = weight.asDiagonal() * (rows * wanted);
  shares *= std::min(1.0, kMostLeverage / std::max(shares.lpNorm<1>(), 1e-12));
  std::vector<FrameShare> result;
  for (Index k = 0; k < count; ++k) result.push_back({near[static_cast<std::size_t>(k)].frame, shares[k]});
  return result;
}

// With their parents and children, but for roots: tissue passes on what these do.
std::vector<std::uint32_t> with_next(const Skeleton& skeleton, const std::vector<std::uint32_t>& joints) {
  std::set<std::uint32_t> all(joints.begin(), joints.end());
  for (std::uint32_t j = 0; j < skeleton.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    if (parent < 0) continue;
    const auto up = static_cast<std::uint32_t>(parent);
    const auto moves = [&](std::uint32_t joint) {
      return std::find(joints.begin(), joints.end(), joint) != joints.end();
    };
    if (moves(up)) all.insert(j);
    if (moves(j) && skeleton.joints[up].parent >= 0) all.insert(up);
  }
  return {all.begin(), all.end()};
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
    parts.push_back({std::move(region), with_next(character.skeleton, joints_moving(character, mask))});
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
  const std::vector<int> stretches = stretches_of(database, part);
  parallel_for(database.frames.size(), [&](std::size_t n) {
    if (!used[n]) return;
    std::vector<Neighbour> near = neighbours_of(database, part, n, reach, stretches, used);
    models.neighbours[n] = static_cast<int>(near.size());
    if (near.back().pass == 0) return;
    const auto own = std::find_if(near.begin(), near.end(), [n](const Neighbour& k) { return k.frame == n; });
    const int own_pass = own->pass;
    std::stable_sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.distance < b.distance; });
    keep_nearest(near);
    for (const Neighbour& other : near) {
      if (other.pass != own_pass) models.others[n].push_back(other.frame);
    }
    if (!models.others[n].empty()) models.shares[n] = fit(near, own_pass, anchors);
  });
  return models;
}

}  // namespace bodyopt
