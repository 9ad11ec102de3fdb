#include "trainer/motion/sweeps.h"

#include <algorithm>
#include <cmath>

#include "trainer/motion/dof_groups.h"
#include "trainer/motion/walk.h"

namespace bodyopt {
namespace {

// The step that visits all keys within `most` frames where that is possible, `least` degrees or more.
double step_within(const std::vector<Angles>& keys, std::size_t most, double least) {
  const auto frames = [&](double step) {
    std::size_t sum = 0;
    for (std::size_t k = 1; k < keys.size(); ++k) sum += steps_between(keys[k - 1], keys[k], step);
    return sum;
  };
  double step = least;
  while (step < 360 && frames(step) > most) step *= 1.02;
  return step;
}

std::vector<Angles> walk_through(const std::vector<Angles>& keys, double step) {
  std::vector<Angles> frames;
  for (std::size_t k = 1; k < keys.size(); ++k) walk(keys[k - 1], keys[k], step, frames);
  return frames;
}

// At most so many of the frames, spread over all of them.
std::vector<Angles> evenly(const std::vector<Angles>& frames, std::size_t most) {
  if (frames.size() <= most) return frames;
  std::vector<Angles> fewer;
  for (std::size_t k = 0; k < most; ++k) fewer.push_back(frames[k * frames.size() / most]);
  return fewer;
}

struct Corner {
  std::size_t first, second;
  double first_angle, second_angle;
};

// Neighbouring corners differ in one angle only.
std::vector<Corner> corners(const JointLimits& limits, const Skeleton& skeleton) {
  std::vector<Corner> list;
  for (const auto& [a, b] : dof_pairs(limits, skeleton)) {
    const DegreeOfFreedom &first = limits.dofs[a], &second = limits.dofs[b];
    list.push_back({a, b, first.min, second.min});
    list.push_back({a, b, first.min, second.max});
    list.push_back({a, b, first.max, second.max});
    list.push_back({a, b, first.max, second.min});
  }
  return list;
}

// Which degrees of freedom are a pair with another: their flesh is shared.
std::vector<std::vector<bool>> touching(const JointLimits& limits, const Skeleton& skeleton) {
  std::vector<std::vector<bool>> touch(limits.dofs.size(), std::vector<bool>(limits.dofs.size()));
  for (const auto& [a, b] : dof_pairs(limits, skeleton)) touch[a][b] = touch[b][a] = true;
  for (std::size_t k = 0; k < limits.dofs.size(); ++k) touch[k][k] = true;
  return touch;
}

}  // namespace

std::vector<Angles> sweeps(const JointLimits& limits, std::size_t most) {
  const Angles rest = rest_angles(limits);
  std::vector<Angles> keys{rest};
  for (std::size_t k = 0; k < limits.dofs.size(); ++k) {
    Angles key = rest;
    for (const double angle : {limits.dofs[k].min, limits.dofs[k].max, limits.dofs[k].rest}) {
      key[k] = angle;
      keys.push_back(key);
    }
  }
  return evenly(walk_through(keys, step_within(keys, most, kSweepStep)), most);
}

std::vector<Angles> pair_blends(const JointLimits& limits, const Skeleton& skeleton, const SelfOverlap& overlap,
                                std::size_t most) {
  const Angles rest = rest_angles(limits);
  const auto clear = [&](const Angles& angles) { return !overlap.find(limited_pose(skeleton, limits, {angles})); };
  const std::vector<std::vector<bool>> touch = touching(limits, skeleton);
  std::vector<Corner> left = corners(limits, skeleton);
  std::vector<Angles> keys{rest};
  while (!left.empty()) {
    Angles key = rest;
    std::vector<std::size_t> moved;
    std::vector<Corner> later;
    for (const Corner& corner : left) {
      const bool free = std::none_of(moved.begin(), moved.end(),
                                     [&](std::size_t k) { return touch[k][corner.first] || touch[k][corner.second]; });
      Angles with = key;
      with[corner.first] = corner.first_angle;
      with[corner.second] = corner.second_angle;
      if (free && clear(with)) {
        key = with;
        moved.insert(moved.end(), {corner.first, corner.second});
      } else if (!moved.empty()) {
        later.push_back(corner);
      }  // else the corner overlaps all alone
    }
    if (!moved.empty()) keys.push_back(key);
    left = later;
  }
  keys.push_back(rest);

  std::vector<Angles> frames = walk_through(keys, step_within(keys, most, kBlendStep));
  std::erase_if(frames, [&](const Angles& angles) { return !clear(angles); });
  return evenly(frames, most);
}

}  // namespace bodyopt
