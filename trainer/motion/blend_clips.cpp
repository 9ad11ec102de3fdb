#include "trainer/motion/blend_clips.h"

#include <algorithm>
#include <numbers>

#include "trainer/motion/explore.h"

namespace bodyopt {
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

  // About axes of the joint's own space: deviations know no direction.
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

}  // namespace bodyopt
