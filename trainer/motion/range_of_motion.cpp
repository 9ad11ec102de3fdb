#include "trainer/motion/range_of_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include "assets/characters/joints_with_skin.h"
#include "base/spread_evenly.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"

namespace bodyopt::trainer {
namespace {

constexpr int kPoseCandidates = 24;
constexpr int kOtherTargets = 12;    // other targets when limbs are in the way
constexpr double kAsExamples = 0.2;  // share of the blends in which no joint deviates

double cosine(const Quat& a, const Quat& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]; }

Pose blend(const Pose& a, const Pose& b, double t) {
  Pose between = a;
  for (std::size_t j = 0; j < a.joints.size(); ++j) {
    between.joints[j].rotation = slerp(a.joints[j].rotation, b.joints[j].rotation, t);
  }
  return between;
}

// The sum of the squared sines of half the angles between the joints.
double squared_distance(const Pose& a, const Pose& b) {
  double sum = 0;
  for (std::size_t j = 0; j < a.joints.size(); ++j) {
    const double c = cosine(a.joints[j].rotation, b.joints[j].rotation);
    sum += std::max(0.0, 1 - c * c);
  }
  return sum;
}

class BlendWalk {
 public:
  BlendWalk(const std::vector<Pose>& examples, const SelfOverlap& overlap, const std::vector<Pose>& covered,
            const BlendOptions& options)
      : examples_(examples), overlap_(overlap), options_(options), random_(options.seed), been_(covered) {
    been_.reserve(covered.size() + options.frames);
  }

  std::vector<Pose> run() {
    const std::size_t begin = been_.size(), end = begin + options_.frames;
    int blocked = 0;
    while (been_.size() < end) {
      const Pose target = choose_target();
      while (been_.size() < end) {
        const double left = largest_turn(been_.back(), target);
        const bool arrives = left <= options_.step || blocked >= kOtherTargets;
        Pose next = arrives ? target : blend(been_.back(), target, options_.step / left);
        if (!arrives && overlap_.find(next)) {
          ++blocked;
          break;
        }
        been_.push_back(std::move(next));
        blocked = 0;
        if (arrives) break;
      }
    }
    return {been_.begin() + static_cast<std::ptrdiff_t>(begin), been_.end()};
  }

 private:
  const Pose& example() { return examples_[random_.below(examples_.size())]; }

  Pose choose_target() {
    double farthest = -1;
    Pose best = example();
    for (int k = 0; k < kPoseCandidates; ++k) {
      const Pose &a = example(), &b = example();
      Pose candidate = deviating(blend(a, b, random_.next()));
      const double distance = squared_distance_to_been(candidate, farthest);
      if (distance <= farthest || overlap_.find(candidate)) continue;
      farthest = distance;
      best = std::move(candidate);
    }
    return best;
  }

  // Turns about axes of the joint's own space: deviations know no direction.
  Pose deviating(Pose pose) {
    if (random_.next() < kAsExamples) return pose;
    for (const JointDeviation& deviation : options_.deviations) {
      const Vec3 turn = (deviation.degrees * std::numbers::pi / 180) * random_.in_ball();
      const double angle = length(turn);
      Quat& rotation = pose.joints[deviation.joint].rotation;
      if (angle > 0) rotation = rotation * axis_angle((1 / angle) * turn, angle);
    }
    return pose;
  }

  // May stop once it is known to be `enough` or less.
  double squared_distance_to_been(const Pose& pose, double enough) const {
    double nearest = 1e300;
    for (auto other = been_.rbegin(); other != been_.rend() && nearest > enough; ++other) {
      nearest = std::min(nearest, squared_distance(pose, *other));
    }
    return nearest;
  }

  const std::vector<Pose>& examples_;
  const SelfOverlap& overlap_;
  BlendOptions options_;
  UniformRandom random_;
  std::vector<Pose> been_;
};

inline constexpr double kSweepStep = 10;  // degrees
inline constexpr double kBlendStep = 20;  // degrees

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

// Keeps so many of the frames at most, spread over all of them.
std::vector<Angles> evenly(const std::vector<Angles>& frames, std::size_t most) {
  return transformed(spread_evenly(frames.size(), most), [&](std::size_t k) { return frames[k]; });
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

// Whether two degrees of freedom are a pair: their flesh is shared.
std::vector<std::vector<bool>> touching(const JointLimits& limits, const Skeleton& skeleton) {
  std::vector<std::vector<bool>> touch(limits.dofs.size(), std::vector<bool>(limits.dofs.size()));
  for (const auto& [a, b] : dof_pairs(limits, skeleton)) touch[a][b] = touch[b][a] = true;
  for (std::size_t k = 0; k < limits.dofs.size(); ++k) touch[k][k] = true;
  return touch;
}

// Sweeps one degree of freedom after the other, from rest to the lower limit, the upper limit and back, the others at
// rest. Steps are kSweepStep degrees, or longer where `most` frames are too few.
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

// The four corners of the limits of every pair (see dof_pairs), others at rest. A key holds corners of several pairs
// that do not touch each other. Corners in which limbs overlap are left out. `most` frames at most.
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

constexpr double kSweepShare = 0.06, kPairShare = 0.04;  // of the frames

constexpr int kMostRedrawn = 50;  // times that limbs of a pose are in the way
constexpr int kMostLost = 20;     // poses in a row
constexpr double kMoves = 0.1;    // degrees

std::vector<Quat> rotations(const std::vector<Pose>& poses, std::uint32_t joint) {
  return transformed(poses, [&](const Pose& pose) { return normalized(pose.joints[joint].rotation); });
}

double angle_to_nearest(const Quat& q, const std::vector<Quat>& others) {
  const auto cosine = [&](const Quat& o) { return std::abs(q[0] * o[0] + q[1] * o[1] + q[2] * o[2] + q[3] * o[3]); };
  const auto further = [&](const Quat& a, const Quat& b) { return cosine(a) < cosine(b); };
  return angle_of(conjugate(q) * *std::max_element(others.begin(), others.end(), further));
}

bool turns_any(const DegreeOfFreedom& dof, const std::set<std::uint32_t>& joints) {
  return std::any_of(dof.turns.begin(), dof.turns.end(),
                     [&](const JointTurn& turn) { return joints.contains(turn.joint); });
}

void redraw(const JointLimits& limits, const std::set<std::uint32_t>& joints, UniformRandom& random, Angles& angles) {
  const Angles others = random_angles(limits, random);
  for (std::size_t k = 0; k < angles.size(); ++k) {
    if (turns_any(limits.dofs[k], joints)) angles[k] = others[k];
  }
}

// Limbs that are in each other's way are drawn anew, and these alone. Hardly any whole pose drawn anew would be clear
// where there are many joints.
std::optional<Angles> clear_angles(const JointLimits& limits, const Skeleton& skeleton, const SelfOverlap& overlap,
                                   UniformRandom& random) {
  Angles angles = random_angles(limits, random);
  for (int redrawn = 0; redrawn < kMostRedrawn; ++redrawn) {
    const auto found = overlap.find(limited_pose(skeleton, limits, {angles}));
    if (!found) return angles;
    redraw(limits, joints_between(skeleton, found->first, found->second), random, angles);
  }
  return std::nullopt;
}

// Poses in which two limbs touch, all pairs of limbs that can in turns.
constexpr double kTouchShare = 0.25;   // of the frames
constexpr double kDeepestTouch = 0.5;  // of the radius of the smaller limb
constexpr int kTouchCandidates = 16, kMostWithoutTouch = 50, kHalvings = 10;

// Poses on the way from one without overlap to one that differs by a limb, and overlaps, where that is as deep as
// wanted. Among several such ways it is the one that ends at limbs that have touched least so far.
class TouchingPoses {
 public:
  TouchingPoses(const JointLimits& limits, const Skeleton& skeleton, const SelfOverlap& overlap, std::uint64_t seed)
      : limits_(limits), skeleton_(skeleton), overlap_(overlap), random_(seed) {}

  // `count`, or fewer where limbs hardly reach each other.
  std::vector<Angles> find(std::size_t count) {
    std::vector<Angles> found;
    for (int lost = 0; lost < kMostWithoutTouch && found.size() < count; ++lost) {
      const std::optional<Angles> clear = clear_angles(limits_, skeleton_, overlap_, random_);
      if (!clear) continue;
      const std::optional<Angles> beyond = least_touched(*clear);
      if (!beyond) continue;
      found.push_back(between(*clear, *beyond, kDeepestTouch * random_.next()));
      ++touched_[touch(found.back()).joints];
      lost = -1;
    }
    return found;
  }

 private:
  SelfOverlap::Touch touch(const Angles& angles) const {
    return overlap_.deepest(limited_pose(skeleton_, limits_, {angles}));
  }

  std::optional<Angles> least_touched(const Angles& clear) {
    std::optional<Angles> best;
    int least = 0;
    for (int k = 0; k < kTouchCandidates; ++k) {
      Angles candidate = clear;
      const std::uint32_t tip = limits_.dofs[random_.below(limits_.dofs.size())].turns.front().joint;
      redraw(limits_, joints_between(skeleton_, tip, 0), random_, candidate);
      const SelfOverlap::Touch at = touch(candidate);
      if (!(at.depth > kDeepestTouch)) continue;
      const int times = touched_[at.joints];
      if (best && times >= least) continue;
      least = times;
      best = std::move(candidate);
    }
    return best;
  }

  Angles between(Angles clear, Angles beyond, double depth) const {
    for (int k = 0; k < kHalvings; ++k) {
      Angles middle = clear;
      for (std::size_t i = 0; i < middle.size(); ++i) middle[i] = 0.5 * (clear[i] + beyond[i]);
      (touch(middle).depth > depth ? beyond : clear) = std::move(middle);
    }
    return clear;
  }

  const JointLimits& limits_;
  const Skeleton& skeleton_;
  const SelfOverlap& overlap_;
  UniformRandom random_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> touched_;
};

}  // namespace

double largest_turn(const Pose& from, const Pose& to) {
  double largest = 0;
  for (std::size_t j = 0; j < from.joints.size(); ++j) {
    largest = std::max(largest, angle_of(conjugate(from.joints[j].rotation) * to.joints[j].rotation));
  }
  return largest;
}

std::vector<Pose> blend_clips(const std::vector<Pose>& examples, const SelfOverlap& overlap,
                              const std::vector<Pose>& covered, const BlendOptions& options) {
  return BlendWalk(examples, overlap, covered, options).run();
}

std::vector<Pose> in_place(const Skeleton& skeleton, const std::vector<Pose>& poses) {
  const Pose bind = bind_pose(skeleton);
  std::vector<Pose> result;
  for (const Pose& pose : poses) {
    Pose& own = result.emplace_back(bind);
    for (std::size_t j = 0; j < skeleton.size(); ++j) {
      if (skeleton.joints[j].parent >= 0) own.joints[j].rotation = normalized(pose.joints[j].rotation);
    }
  }
  return result;
}

RangeOfMotion range_of_motion(const Character& character, const JointLimits& limits,
                              const RangeOfMotionOptions& options) {
  if (options.frames < 1) {
    throw Error(ErrorKind::usage, "a clip needs 1 frame or more, not " + std::to_string(options.frames));
  }
  const Skeleton& skeleton = character.skeleton;
  const std::size_t count = static_cast<std::size_t>(options.frames);
  const auto share = [&](double part) { return static_cast<std::size_t>(part * static_cast<double>(count)); };
  RangeOfMotion result;
  std::vector<Posture>& frames = result.postures;
  const auto append = [&](const std::vector<Angles>& more) {
    const std::size_t added = std::min(more.size(), count - frames.size());
    for (std::size_t k = 0; k < added; ++k) frames.push_back({more[k]});
    return added;
  };

  frames.push_back({rest_angles(limits)});
  result.sweep_frames = append(sweeps(limits, share(kSweepShare)));
  SelfOverlap overlap = overlap_of_limits(character, limits);
  result.pair_frames = append(pair_blends(limits, skeleton, overlap, share(kPairShare)));
  const double blended = options.examples.empty() ? 0 : options.blends;
  if (blended < 1 && options.step == RangeOfMotionOptions{}.step) {
    result.touching_frames = append(TouchingPoses(limits, skeleton, overlap, options.seed).find(share(kTouchShare)));
  }
  result.random_frames = count - frames.size();
  const auto blends = static_cast<std::size_t>(std::lround(blended * static_cast<double>(result.random_frames)));
  if (blends < result.random_frames) {
    const std::vector<Posture> random =
        explore(limits, skeleton, overlap, frames, {result.random_frames - blends, options.seed, options.step});
    frames.insert(frames.end(), random.begin(), random.end());
  }
  if (blends > 0) {
    const std::vector<Pose> examples = in_place(skeleton, options.examples);
    for (const Pose& example : examples) overlap.trust(example);
    result.blends = blend_clips(examples, overlap, clip_of(result, limits, skeleton).poses,
                                {blends, options.seed, options.step, limits.deviations});
  }
  for (std::size_t k = 1; k < frames.size(); ++k) {
    result.largest_step = std::max(result.largest_step, largest_change(frames[k - 1], frames[k]));
  }
  const Clip clip = clip_of(result, limits, skeleton);
  for (std::size_t k = frames.size(); k < clip.poses.size(); ++k) {
    result.largest_step = std::max(result.largest_step, largest_turn(clip.poses[k - 1], clip.poses[k]));
  }
  return result;
}

std::size_t frames_for_sweeps(const JointLimits& limits) {
  constexpr double kFramesOfOne = 3;  // its two ends, and rest
  return static_cast<std::size_t>(std::ceil(kFramesOfOne * static_cast<double>(limits.dofs.size()) / kSweepShare));
}

SelfOverlap overlap_of_limits(const Character& character, const JointLimits& limits) {
  // The sweep of one degree of freedom alone is within the limits by the word of their author.
  SelfOverlap overlap(character);
  for (const Angles& angles : sweeps(limits, std::numeric_limits<std::size_t>::max())) {
    overlap.trust(limited_pose(character.skeleton, limits, {angles}));
  }
  for (const CommonPose& pose : limits.poses) overlap.trust(limited_pose(character.skeleton, limits, {pose.angles}));
  return overlap;
}

Clip clip_of(const RangeOfMotion& motion, const JointLimits& limits, const Skeleton& skeleton) {
  Clip clip;
  clip.name = "range_of_motion";
  for (const Posture& posture : motion.postures) clip.poses.push_back(limited_pose(skeleton, limits, posture));
  clip.poses.insert(clip.poses.end(), motion.blends.begin(), motion.blends.end());
  return clip;
}

std::vector<JointCoverage> coverage(const std::vector<Pose>& frames, const std::vector<Pose>& wanted,
                                    const Character& character) {
  const Skeleton& skeleton = character.skeleton;
  std::vector<JointCoverage> result;
  for (const std::uint32_t joint : joints_that_bend(character)) {
    const Quat bind = normalized(skeleton.joints[joint].bind.rotation);
    const std::vector<Quat> shown = rotations(frames, joint), asked = rotations(wanted, joint);
    const auto moves = [&](const Quat& q) { return angle_of(conjugate(q) * bind) > kMoves; };
    if (std::none_of(shown.begin(), shown.end(), moves) && std::none_of(asked.begin(), asked.end(), moves)) continue;
    const double none = asked.empty() ? std::numeric_limits<double>::quiet_NaN() : 0;
    JointCoverage measured{skeleton.joints[joint].name, none, none};
    for (const Quat& q : asked) {
      const double angle = angle_to_nearest(q, shown);
      measured.mean += angle / static_cast<double>(asked.size());
      measured.largest = std::max(measured.largest, angle);
    }
    result.push_back(measured);
  }
  return result;
}

std::vector<Pose> random_poses(const JointLimits& limits, const Skeleton& skeleton, const SelfOverlap& overlap,
                               std::size_t count, std::uint64_t seed) {
  UniformRandom random(seed);
  std::vector<Pose> poses;
  for (int lost = 0; lost < kMostLost && poses.size() < count; ++lost) {
    const std::optional<Angles> angles = clear_angles(limits, skeleton, overlap, random);
    if (!angles) continue;
    poses.push_back(limited_pose(skeleton, limits, {*angles}));
    lost = -1;
  }
  return poses;
}

}  // namespace bodyopt::trainer
