#include "trainer/motion/explore.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "trainer/motion/walk.h"

namespace bodyopt {
namespace {

constexpr int kCandidates = 24;
constexpr int kTries = 12;  // other targets when nothing can move, before a frame is repeated

class Explorer {
 public:
  Explorer(const JointLimits& limits, const Skeleton& skeleton, const SelfOverlap& overlap,
           const std::vector<Angles>& covered, const ExploreOptions& options)
      : limits_(limits),
        skeleton_(skeleton),
        overlap_(overlap),
        options_(options),
        random_(options.seed),
        groups_(dof_groups(limits)),
        been_(covered),
        at_(covered.back()),
        target_(at_) {
    been_.reserve(covered.size() + options.frames);
  }

  std::vector<Angles> run() {
    const std::size_t begin = been_.size();
    while (been_.size() < begin + options_.frames) {
      for (int tried = 0; tried < kTries && !step(); ++tried) {
      }
      been_.push_back(at_);
    }
    return {been_.begin() + static_cast<std::ptrdiff_t>(begin), been_.end()};
  }

 private:
  // Every group moves on that can; those whose limbs would run into each other stay and choose another target. Ends,
  // because where all stay, nothing overlaps more than before. False when nothing moves.
  bool step() {
    for (const DofGroup& group : groups_) {
      if (arrived(group)) choose_target(group);
    }
    std::vector<bool> moves(groups_.size(), true);
    Angles next = towards_target(moves);
    while (const auto found = overlap_.find(limited_pose(skeleton_, limits_, next))) {
      const std::set<std::uint32_t> between = joints_between(found->first, found->second);
      bool held = false;
      for (std::size_t g = 0; g < groups_.size(); ++g) {
        if (!moves[g] || !turns_any(groups_[g], between)) continue;
        moves[g] = false;
        held = true;
        choose_target(groups_[g]);
      }
      if (!held) return false;
      next = towards_target(moves);
    }
    const bool moved = next != at_;
    at_ = next;
    return moved;
  }

  bool arrived(const DofGroup& group) const {
    return std::all_of(group.begin(), group.end(), [&](std::size_t k) { return at_[k] == target_[k]; });
  }

  void choose_target(const DofGroup& group) {
    double farthest = -1;
    Angles best;
    for (int k = 0; k < kCandidates; ++k) {
      const Angles candidate = random_angles(limits_, random_);
      const double distance = squared_distance_to_covered(candidate, group, farthest);
      if (distance <= farthest) continue;
      farthest = distance;
      best = candidate;
    }
    for (const std::size_t k : group) target_[k] = best[k];
  }

  // In the group's angles; may stop once it is known to be `enough` or less.
  double squared_distance_to_covered(const Angles& angles, const DofGroup& group, double enough) const {
    double nearest = 1e300;
    for (auto other = been_.rbegin(); other != been_.rend() && nearest > enough; ++other) {
      double sum = 0;
      for (const std::size_t k : group) sum += (angles[k] - (*other)[k]) * (angles[k] - (*other)[k]);
      nearest = std::min(nearest, sum);
    }
    return nearest;
  }

  // One step of the groups that move on the straight line to their targets.
  Angles towards_target(const std::vector<bool>& moves) const {
    Angles next = at_;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      if (!moves[g]) continue;
      const DofGroup& group = groups_[g];
      double left = 0;
      for (const std::size_t k : group) left = std::max(left, std::abs(target_[k] - at_[k]));
      if (left <= options_.step) {
        for (const std::size_t k : group) next[k] = target_[k];
      } else {
        for (const std::size_t k : group) next[k] = at_[k] + options_.step / left * (target_[k] - at_[k]);
      }
    }
    return next;
  }

  // The joints that move `a` relative to `b`: from both up to, and without, their common ancestor.
  std::set<std::uint32_t> joints_between(std::uint32_t a, std::uint32_t b) const {
    const auto chain = [&](std::uint32_t joint) {
      std::set<std::uint32_t> joints;
      for (int j = static_cast<int>(joint); j >= 0; j = skeleton_.joints[static_cast<std::size_t>(j)].parent) {
        joints.insert(static_cast<std::uint32_t>(j));
      }
      return joints;
    };
    const std::set<std::uint32_t> up_a = chain(a), up_b = chain(b);
    std::set<std::uint32_t> between;
    std::set_symmetric_difference(up_a.begin(), up_a.end(), up_b.begin(), up_b.end(),
                                  std::inserter(between, between.end()));
    return between;
  }

  bool turns_any(const DofGroup& group, const std::set<std::uint32_t>& joints) const {
    return std::any_of(group.begin(), group.end(), [&](std::size_t k) {
      const std::vector<JointTurn>& turns = limits_.dofs[k].turns;
      return std::any_of(turns.begin(), turns.end(),
                         [&](const JointTurn& turn) { return joints.contains(turn.joint); });
    });
  }

  const JointLimits& limits_;
  const Skeleton& skeleton_;
  const SelfOverlap& overlap_;
  const ExploreOptions& options_;
  UniformRandom random_;
  std::vector<DofGroup> groups_;
  std::vector<Angles> been_;
  Angles at_, target_;
};

}  // namespace

// SplitMix64 (Steele, Lea and Flood 2014).
double UniformRandom::next() {
  std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  z ^= z >> 31;
  return static_cast<double>(z >> 11) * 0x1p-53;
}

std::size_t UniformRandom::below(std::size_t count) {
  return static_cast<std::size_t>(next() * static_cast<double>(count));
}

Angles random_angles(const JointLimits& limits, UniformRandom& random) {
  Angles angles;
  for (const DegreeOfFreedom& dof : limits.dofs) angles.push_back(dof.min + random.next() * (dof.max - dof.min));
  return angles;
}

std::vector<Angles> explore(const JointLimits& limits, const Skeleton& skeleton, const SelfOverlap& overlap,
                            const std::vector<Angles>& covered, const ExploreOptions& options) {
  return Explorer(limits, skeleton, overlap, covered, options).run();
}

}  // namespace bodyopt
