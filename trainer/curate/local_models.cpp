#include "trainer/curate/local_models.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include "base/linear_algebra.h"
#include "base/parallel.h"
#include "trainer/curate/pose_space.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;

constexpr std::size_t kMostNeighbours = 48, kMostOfPass = 8;
constexpr double kAnchor = 10;
constexpr std::size_t kMostAsked = 32;  // frames whose neighbours say how much of what is history
// The variances that are tried, in units of how much shapes vary with the pose, and the lengths, in units of the reach.
constexpr std::array kLengths = {0.25, 0.5, 1.0, 2.0, 4.0, 8.0};
constexpr std::array kPasses = {0.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 10.0};
constexpr std::array kNoises = {1e-6, 1e-4, 1e-2};
constexpr std::array kOthers = {0.0, 0.1, 1.0};  // how much joints from afar count
constexpr double kChance = 4.74;                 // of four variances; Wilks 1938: 95 of 100 ratios are smaller
// Frames in the same pose, of all joints: so far apart at most, as a part of the reach.
constexpr double kSamePose = 0.2;
constexpr double kHalfStep = 3.2;  // half the step between the variances that are tried: what is as good as equal
constexpr double kTurned = 0.005;  // the sine of half the angle
constexpr double kLeastStep = 0.1 * std::numbers::pi / 180;  // radians: shorter ones have no direction of their own

struct Neighbour {
  std::size_t frame = 0;
  Eigen::VectorXd difference, others;  // of the part's joints, and of the others, as a part of the reach
  double distance = 0;
  int pass = 0;
};

constexpr double kLeastNearness = 1e-3;

// 1 at 0, 0 from 1 on (Tukey's biweight).
double nearness(double distance) {
  const double left = 1 - distance * distance;
  return left > 0 ? left * left : 0;
}

// Whether a frame of the database follows another in its take, with one between them at most.
bool follows(const PoseDatabase& database, std::size_t before, std::size_t frame) {
  return frame - before <= 2 && database.frames[frame].take == database.frames[before].take;
}

// Numbers the frames by stretches of a take that go one way. Where it turns back the next stretch begins, because what
// led to the turn is its history.
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
    const Pose &own = database.frames[frame].pose, &there = database.frames[n].pose;
    if (!used[n] || !is_near(own, there, part.joints, 1.001 * reach)) continue;
    Neighbour other{n, pose_difference(own, there, part.joints) / reach,
                    turns_between(own, there, part.others) / reach};
    other.distance = other.difference.norm();
    if (other.distance < 1) near.push_back(std::move(other));
  }
  number_passes(database, stretches, near);
  return near;
}

// The nearest, of every pass a few, and the frame itself, which others of its pose may stand before. `near`: by rising
// distance.
void keep_nearest(std::size_t own, std::vector<Neighbour>& near) {
  const auto self = std::ranges::find(near, own, &Neighbour::frame);
  std::rotate(near.begin(), self, self + 1);
  std::map<int, std::size_t> kept;
  std::erase_if(near, [&](const Neighbour& other) { return ++kept[other.pass] > kMostOfPass; });
  if (near.size() > kMostNeighbours) near.resize(kMostNeighbours);
}

// How shapes near a pose vary: smoothly with the pose, by what a pass is off by, and from frame to frame.
struct Variances {
  double length = 1, others = 0, pass = 0, noise = 0;
};
// History is hardly any of what shapes of like poses differ by, and nearly all of what those of the same pose do.
constexpr Variances kUsual = {1, 0.1, 1e-3, 1e-4};

// How far the poses of neighbours are apart, squared, M x M: in the part's joints, and in the others.
struct Apart {
  Eigen::MatrixXd own, others;
};

Apart apart_of(const std::vector<Neighbour>& near) {
  const Index count = static_cast<Index>(near.size());
  Apart apart{Eigen::MatrixXd::Zero(count, count), Eigen::MatrixXd::Zero(count, count)};
  for (Index k = 0; k < count; ++k) {
    for (Index l = 0; l < count; ++l) {
      const Neighbour &one = near[static_cast<std::size_t>(k)], &other = near[static_cast<std::size_t>(l)];
      apart.own(k, l) = (one.difference - other.difference).squaredNorm();
      apart.others(k, l) = (one.others - other.others).squaredNorm();
    }
  }
  return apart;
}

// The covariance of the neighbours' shapes, M x M. Passes with anchors are off by little. Those further away count
// less.
Eigen::MatrixXd covariance(const std::vector<Neighbour>& near, const Apart& apart, const Variances& variances,
                           const std::vector<char>& anchors) {
  const Index count = static_cast<Index>(near.size());
  std::set<int> anchored;
  for (const Neighbour& other : near) {
    if (anchors[other.frame]) anchored.insert(other.pass);
  }
  Eigen::MatrixXd result(count, count);
  for (Index k = 0; k < count; ++k) {
    const Neighbour& one = near[static_cast<std::size_t>(k)];
    for (Index l = 0; l < count; ++l) {
      const Neighbour& other = near[static_cast<std::size_t>(l)];
      const double squared = apart.own(k, l) + variances.others * apart.others(k, l);
      result(k, l) = std::exp(-0.5 * squared / (variances.length * variances.length));
      if (one.pass == other.pass) result(k, l) += variances.pass / (anchored.contains(one.pass) ? kAnchor : 1);
    }
    result(k, k) += variances.noise / std::max(nearness(one.distance), kLeastNearness);
  }
  return result;
}

// The inverse of a covariance for an unknown mean, and the log determinants that restricted likelihood subtracts.
struct Precision {
  Eigen::MatrixXd matrix;  // M x M
  double log_volume = 0;
};

Precision precision(const Eigen::MatrixXd& covariance) {
  const Cholesky solver(covariance);
  Precision result;
  result.matrix = solver.solve(Eigen::MatrixXd::Identity(covariance.rows(), covariance.cols()));
  const Eigen::VectorXd of_mean = result.matrix.rowwise().sum();
  result.log_volume = 2 * solver.lower().diagonal().array().log().sum() + std::log(of_mean.sum());
  result.matrix -= of_mean * of_mean.transpose() / of_mean.sum();
  return result;
}

// The displacements of neighbours over a part of the skin, weighted, M x 3 part vertices.
Eigen::MatrixXd shapes_of(const std::vector<Neighbour>& near, const SkinPart& part,
                          const Displacements& displacements) {
  const std::vector<std::uint32_t>& vertices = part.region.vertices;
  Eigen::MatrixXd rows(static_cast<Index>(near.size()), 3 * static_cast<Index>(vertices.size()));
  for (Index k = 0; k < rows.rows(); ++k) {
    const auto shape = displacements.row(static_cast<Index>(near[static_cast<std::size_t>(k)].frame));
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      rows.row(k).segment<3>(3 * static_cast<Index>(v)) =
          std::sqrt(part.region.weights[v]) * shape.segment<3>(3 * Index{vertices[v]}).cast<double>();
    }
  }
  return rows;
}

// Inner products of the neighbours' displacements over a part of the skin, M x M.
Eigen::MatrixXd products(const std::vector<Neighbour>& near, const SkinPart& part, const Displacements& displacements) {
  Eigen::MatrixXd rows = shapes_of(near, part, displacements);
  rows.rowwise() -= rows.colwise().mean().eval();
  return rows * rows.transpose();
}

// How shapes of one pose vary from motion to motion: a variogram's nugget (Matheron 1963). A function of the pose
// differs less and less as poses come nearer, however sharply it bends where skin touches skin. History stays.
struct Nugget {
  double variance = 0;     // of what a pass is off by, summed over the part of the skin
  std::size_t pairs = 0;   // of frames in the same pose, of other passes: none tell nothing
  std::size_t frames = 0;  // that are in such pairs
};

// How far whole poses are apart, squared, as a part of the reach: what touches what depends on every joint.
double whole_distance(const Neighbour& other) { return other.difference.squaredNorm() + other.others.squaredNorm(); }

// Squared distances between the shapes of a frame and others over a part of the skin, weighted.
Eigen::VectorXd differences(const Neighbour& frame, const std::vector<Neighbour>& others, const SkinPart& part,
                            const Displacements& displacements) {
  const Eigen::MatrixXd own = shapes_of({frame}, part, displacements);
  return (shapes_of(others, part, displacements).rowwise() - own.row(0)).rowwise().squaredNorm();
}

// How steeply shapes change with the pose where a motion goes on by a distance or further: the largest squared
// difference over squared distance. None: it has no frame as far; in the very same pose nothing changes.
std::optional<double> steepest(const std::vector<Neighbour>& motion, const Eigen::VectorXd& differences,
                               double distance) {
  constexpr double kVerySame = 1e-12;
  std::optional<double> slope;
  if (distance <= kVerySame) slope = 0;
  for (std::size_t k = 0; k < motion.size(); ++k) {
    const double gone = whole_distance(motion[k]);
    if (!(gone > 0) || gone < distance) continue;
    slope = std::max(slope.value_or(0), differences[static_cast<Index>(k)] / gone);
  }
  return slope;
}

// The nugget of the pairs of the frame `own`, which is among its neighbours. It is half of what their shapes differ by
// beyond what poses so far apart explain.
Nugget nugget_at(const std::vector<Neighbour>& near, std::size_t own, const SkinPart& part,
                 const Displacements& displacements) {
  const Neighbour self = *std::ranges::find(near, own, &Neighbour::frame);
  std::vector<Neighbour> motion, others;
  for (const Neighbour& other : near) {
    if (other.pass == self.pass) {
      motion.push_back(other);
    } else if (whole_distance(other) <= kSamePose * kSamePose) {
      others.push_back(other);
    }
  }
  Nugget nugget;
  if (others.empty()) return nugget;
  const Eigen::VectorXd along = differences(self, motion, part, displacements),
                        apart = differences(self, others, part, displacements);
  for (std::size_t k = 0; k < others.size(); ++k) {
    const double distance = whole_distance(others[k]);
    const std::optional<double> slope = steepest(motion, along, distance);
    if (!slope) continue;
    nugget.variance += 0.5 * (apart[static_cast<Index>(k)] - *slope * distance);
    ++nugget.pairs;
  }
  nugget.frames = nugget.pairs > 0 ? 1 : 0;
  return nugget;
}

Nugget nugget_of(const std::vector<std::vector<Neighbour>>& near, const SkinPart& part,
                 const Displacements& displacements) {
  std::vector<Nugget> of_frames(near.size());
  parallel_for(near.size(), [&](std::size_t n) {
    if (!near[n].empty()) of_frames[n] = nugget_at(near[n], n, part, displacements);
  });
  Nugget nugget;
  for (const Nugget& of_frame : of_frames) {
    nugget.variance += of_frame.variance;
    nugget.pairs += of_frame.pairs;
    nugget.frames += of_frame.frames;
  }
  if (nugget.pairs > 0) nugget.variance = std::max(0.0, nugget.variance / static_cast<double>(nugget.pairs));
  return nugget;
}

struct Asked {
  std::vector<Neighbour> near;
  Apart apart;
  Eigen::MatrixXd products;
};

// How well variances go with what neighbours look like.
struct Fit {
  double log_likelihood = 0;  // restricted, per dimension of the shapes
  double scale = 0;           // what the variances are in units of, summed over the part of the skin
};

Fit fit_of(const Asked& asked, const Variances& variances, const std::vector<char>& anchors) {
  const Precision given = precision(covariance(asked.near, asked.apart, variances, anchors));
  const double rounding = 1e-14 * asked.products.trace();
  const double apart = std::max(given.matrix.cwiseProduct(asked.products).sum(), rounding);
  const auto freedom = static_cast<double>(asked.near.size() - 1);
  return {-0.5 * (freedom * std::log(apart) + given.log_volume), apart / freedom};
}

// Gathers what is asked of some of the frames that others pass by.
std::vector<Asked> asked_of(const std::vector<std::vector<Neighbour>>& near, const SkinPart& part,
                            const Displacements& displacements) {
  std::vector<std::size_t> compared;
  for (std::size_t n = 0; n < near.size(); ++n) {
    if (!near[n].empty()) compared.push_back(n);
  }
  std::vector<Asked> asked;
  const std::size_t step = compared.size() / kMostAsked + 1;
  for (std::size_t k = 0; k < compared.size(); k += step) {
    const std::vector<Neighbour>& there = near[compared[k]];
    asked.push_back({there, apart_of(there), products(there, part, displacements)});
    if (!(asked.back().products.trace() > 0)) asked.pop_back();
  }
  return asked;
}

// Frames that pass by each other are asked of each other, again and again: they count once in all.
double independent_share(const std::vector<Asked>& asked) {
  std::set<std::size_t> frames;
  std::size_t count = 0;
  for (const Asked& there : asked) {
    for (const Neighbour& other : there.near) frames.insert(other.frame);
    count += there.near.size();
  }
  return static_cast<double>(frames.size()) / static_cast<double>(std::max<std::size_t>(count, 1));
}

// Two frames alone say nothing of variances, however far they are apart: the usual ones stay where chance may as well
// have made others likelier. The nugget bounds what passes are off by. Smooth functions do not bend as shapes do where
// skin touches skin, and what they leave looks like history.
Variances likeliest(const std::vector<Asked>& asked, const std::vector<char>& anchors, const Nugget& nugget) {
  std::vector<Variances> all{kUsual};
  for (const double pass : kPasses) {
    for (const double others : kOthers) {
      for (const double length : kLengths) {
        for (const double noise : kNoises) all.push_back({length, others, pass, noise});
      }
    }
  }
  const double independent = independent_share(asked);
  std::vector<double> likelihoods(all.size(), 0.0);
  parallel_for(all.size(), [&](std::size_t k) {
    double scale = 0;
    for (const Asked& there : asked) {
      const Fit fit = fit_of(there, all[k], anchors);
      likelihoods[k] += independent * fit.log_likelihood;
      scale += fit.scale / static_cast<double>(asked.size());
    }
    if (k > 0) likelihoods[k] -= kChance;
    if (all[k].pass * scale > kHalfStep * nugget.variance) likelihoods[k] = -std::numeric_limits<double>::infinity();
  });
  return all[static_cast<std::size_t>(std::ranges::max_element(likelihoods) - likelihoods.begin())];
}

// The shares of the neighbours' shapes that add up to what their pass `own` is off by.
std::vector<FrameShare> shares_of(const std::vector<Neighbour>& near, int own, const Variances& variances,
                                  const std::vector<char>& anchors) {
  const Apart apart = apart_of(near);
  const Eigen::MatrixXd with = covariance(near, apart, variances, anchors);
  Variances without = variances;
  without.pass = 0;
  const auto same = std::ranges::find(near, own, &Neighbour::pass) - near.begin();
  const Eigen::VectorXd of_pass = with.col(same) - covariance(near, apart, without, anchors).col(same);
  const Eigen::VectorXd shares = precision(with).matrix * of_pass;
  std::vector<FrameShare> result;
  for (std::size_t k = 0; k < near.size(); ++k) result.push_back({near[k].frame, shares[static_cast<Index>(k)]});
  return result;
}

// One flag for each joint: does it turn from frame to frame?
std::vector<char> turning_joints(const PoseDatabase& database) {
  std::vector<char> turns(database.character.skeleton.size(), 0);
  for (const DatabaseFrame& frame : database.frames) {
    for (std::size_t j = 0; j < turns.size(); ++j) {
      const Quat apart = conjugate(database.frames.front().pose.joints[j].rotation) * frame.pose.joints[j].rotation;
      if (length(Vec3{apart[0], apart[1], apart[2]}) > kTurned) turns[j] = 1;
    }
  }
  return turns;
}

// Adds the nearest joints along the skeleton that turn, beyond roots and joints that do not. Tissue passes on what
// these do, as thighs move a belly.
std::vector<std::uint32_t> with_next(const Skeleton& skeleton, const std::vector<char>& turns,
                                     const std::vector<std::uint32_t>& joints) {
  std::vector<std::vector<std::uint32_t>> beside(skeleton.size());
  for (std::uint32_t j = 0; j < skeleton.size(); ++j) {
    if (skeleton.joints[j].parent < 0) continue;
    const auto parent = static_cast<std::uint32_t>(skeleton.joints[j].parent);
    beside[j].push_back(parent);
    beside[parent].push_back(j);
  }
  std::set<std::uint32_t> seen(joints.begin(), joints.end()), all = seen;
  std::vector<std::uint32_t> open = joints;
  while (!open.empty()) {
    const std::uint32_t from = open.back();
    open.pop_back();
    for (const std::uint32_t next : beside[from]) {
      if (!seen.insert(next).second) continue;
      const bool leads_on = skeleton.joints[next].parent < 0 || !turns[next];
      if (leads_on) open.push_back(next);
      if (skeleton.joints[next].parent >= 0) all.insert(next);
    }
  }
  return {all.begin(), all.end()};
}

// The joints that turn and are not among the given ones (by rising number).
std::vector<std::uint32_t> others_than(const Skeleton& skeleton, const std::vector<char>& turns,
                                       const std::vector<std::uint32_t>& joints) {
  std::vector<std::uint32_t> others;
  for (std::uint32_t j = 0; j < turns.size(); ++j) {
    const bool is_root = skeleton.joints[j].parent < 0;
    if (turns[j] && !is_root && !std::ranges::binary_search(joints, j)) others.push_back(j);
  }
  return others;
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
  const std::vector<char> turns = turning_joints(database);
  std::vector<SkinPart> parts;
  for (RegionWeights& region : regions) {
    if (region.vertices.empty()) continue;
    Eigen::VectorXd mask = Eigen::VectorXd::Zero(vertices);
    for (std::size_t k = 0; k < region.vertices.size(); ++k) mask[Index{region.vertices[k]}] = region.weights[k];
    std::vector<std::uint32_t> joints = with_next(character.skeleton, turns, joints_moving(character, mask));
    std::vector<std::uint32_t> others = others_than(character.skeleton, turns, joints);
    parts.push_back({std::move(region), std::move(joints), std::move(others)});
  }
  return parts;
}

LocalModels local_models(const PoseDatabase& database, const SkinPart& part, double degrees,
                         const std::vector<char>& used, const std::vector<char>& anchors,
                         const Displacements& displacements) {
  const double reach = degrees * std::numbers::pi / 180;
  LocalModels models;
  models.shares.resize(database.frames.size());
  models.others.resize(database.frames.size());
  models.neighbours.resize(database.frames.size(), 0);
  const std::vector<int> stretches = stretches_of(database, part);
  std::vector<std::vector<Neighbour>> near(database.frames.size());
  std::vector<int> own(database.frames.size(), 0);
  parallel_for(database.frames.size(), [&](std::size_t n) {
    if (!used[n]) return;
    std::vector<Neighbour> all = neighbours_of(database, part, n, reach, stretches, used);
    models.neighbours[n] = static_cast<int>(all.size());
    own[n] = std::ranges::find(all, n, &Neighbour::frame)->pass;
    std::ranges::stable_sort(all, {}, &Neighbour::distance);
    keep_nearest(n, all);
    for (const Neighbour& other : all) {
      if (other.pass != own[n]) models.others[n].push_back(other.frame);
    }
    if (!models.others[n].empty()) near[n] = std::move(all);
  });
  const Nugget nugget = nugget_of(near, part, displacements);
  models.same_pose = nugget.frames;
  const Variances variances = likeliest(asked_of(near, part, displacements), anchors, nugget);
  parallel_for(near.size(), [&](std::size_t n) {
    if (!near[n].empty()) models.shares[n] = shares_of(near[n], own[n], variances, anchors);
  });
  return models;
}

}  // namespace bodyopt::trainer
