#include "trainer/motion/explore.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>

#include "base/parallel.h"
#include "base/progress.h"
#include "geometry/mesh.h"
#include "runtime/core/transformed.h"
#include "runtime/host/rig.h"

namespace bodyopt::trainer {
namespace {

template <class Related>
bool any_turns(const DegreeOfFreedom& a, const DegreeOfFreedom& b, Related related) {
  return std::any_of(a.turns.begin(), a.turns.end(), [&](const JointTurn& s) {
    return std::any_of(b.turns.begin(), b.turns.end(), [&](const JointTurn& t) { return related(s.joint, t.joint); });
  });
}

using Eigen::RowVector3d;

constexpr double kLargestRadius = 0.25;  // metres
constexpr double kTolerance = 0.01;      // metres that flesh gives way
constexpr double kSpacing = 0.6;         // of a sphere's radius, to the next centre
constexpr std::size_t kMostPerJoint = 24;
constexpr Eigen::Index kTouchingVertices = 2500;  // spheres are tried at this many vertices of the skin

// The largest sphere inside the skin that touches it at this vertex.
BodySphere touching_sphere(const Character& character, const RowVector3d& at, const RowVector3d& normal,
                           std::uint32_t joint) {
  double radius = kLargestRadius;
  for (int round = 0; round < 30; ++round) {
    const RowVector3d centre = at - radius * normal;
    Eigen::Index nearest;
    const double distance =
        std::sqrt((character.vertices.rowwise() - centre).rowwise().squaredNorm().minCoeff(&nearest));
    if (distance > radius * (1 - 1e-3)) break;
    const RowVector3d chord = at - character.vertices.row(nearest);
    const double along = chord.dot(normal);
    if (!(along > 1e-9)) break;  // the nearest is the vertex itself, or level with it
    radius = std::min(0.999 * radius, chord.squaredNorm() / (2 * along));
  }
  const RowVector3d centre = at - radius * normal;
  return {joint, {centre(0), centre(1), centre(2)}, radius};
}

std::vector<BodySphere> well_spaced(std::vector<BodySphere> candidates) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const BodySphere& a, const BodySphere& b) { return a.radius > b.radius; });
  std::vector<BodySphere> kept;
  for (const BodySphere& sphere : candidates) {
    if (kept.size() == kMostPerJoint) break;
    const bool near = std::any_of(kept.begin(), kept.end(), [&](const BodySphere& other) {
      return length(sphere.centre - other.centre) < kSpacing * other.radius;
    });
    if (!near) kept.push_back(sphere);
  }
  return kept;
}

// The nearest ancestor that has spheres, or -1.
int fleshy_ancestor(const Skeleton& skeleton, const std::vector<bool>& fleshy, std::uint32_t joint) {
  int up = skeleton.joints[joint].parent;
  while (up >= 0 && !fleshy[static_cast<std::size_t>(up)]) up = skeleton.joints[static_cast<std::size_t>(up)].parent;
  return up;
}

constexpr int kTargetCandidates = 16;
constexpr int kTargetsInTheWay = 8;        // of a group whose limbs are in the way, before it is held
constexpr int kTries = 12;                 // other targets when nothing can move, before a frame is repeated
constexpr std::size_t kCompared = 2000;    // earlier frames, spread evenly, that a candidate is held against
constexpr double kAnywhere = 0.4;          // share of the targets; the others lie between common poses
constexpr double kAround = 8;              // degrees either way of such a blend
constexpr double kWithoutDeviation = 0.2;  // share of the targets

// Degrees of freedom that turn joints in common, and the joints. One of either may be missing.
struct MotionGroup {
  DofGroup dofs;
  std::vector<std::uint32_t> joints;
  std::vector<double> deviations;  // of every joint, degrees
};

std::vector<MotionGroup> motion_groups(const JointLimits& limits) {
  std::map<std::uint32_t, double> left;
  for (const JointDeviation& deviation : limits.deviations) left[deviation.joint] = deviation.degrees;
  std::vector<MotionGroup> groups;
  for (const DofGroup& dofs : dof_groups(limits)) {
    std::set<std::uint32_t> joints;
    for (const std::size_t k : dofs) {
      for (const JointTurn& turn : limits.dofs[k].turns) joints.insert(turn.joint);
    }
    MotionGroup& group = groups.emplace_back(MotionGroup{dofs, {joints.begin(), joints.end()}, {}});
    for (const std::uint32_t joint : joints) {
      group.deviations.push_back(left[joint]);
      left.erase(joint);
    }
  }
  for (const auto& [joint, degrees] : left) groups.push_back({{}, {joint}, {degrees}});
  return groups;
}

class Explorer {
 public:
  Explorer(const JointLimits& limits, const Skeleton& skeleton, const SelfOverlap& overlap,
           const std::vector<Posture>& covered, const ExploreOptions& options)
      : limits_(limits),
        skeleton_(skeleton),
        overlap_(overlap),
        options_(options),
        random_(options.seed),
        groups_(motion_groups(limits)),
        at_(covered.back()) {
    at_.deviations.resize(skeleton.size());
    target_ = at_;
    for (const Posture& posture : covered) been_.push_back(turns_of(posture));
  }

  std::vector<Posture> run() {
    std::vector<Posture> frames;
    Progress progress("rom", options_.frames);
    while (frames.size() < options_.frames) {
      for (int tried = 0; tried < kTries && !step(); ++tried) {
      }
      frames.push_back(at_);
      been_.push_back(turns_of(at_));
      progress.advance();
    }
    return frames;
  }

 private:
  using Turns = std::vector<Quat>;  // per joint, away from the bind pose

  Turns turns_of(const Posture& posture) const { return joint_turns(skeleton_.size(), limits_, posture); }

  // Every group moves on that can. Those whose limbs would run into each other choose other targets, and stay where all
  // are in the way. Ends, because where all stay, nothing overlaps more than before. False when nothing moves.
  bool step() {
    for (const MotionGroup& group : groups_) {
      if (left(group) == 0) choose_target(group);
    }
    std::vector<int> chosen(groups_.size());
    Posture next = towards_target(chosen);
    while (const auto found = overlap_.find(limited_pose(skeleton_, limits_, next))) {
      const std::set<std::uint32_t> between = joints_between(skeleton_, found->first, found->second);
      bool changed = false;
      for (std::size_t g = 0; g < groups_.size(); ++g) {
        if (chosen[g] > kTargetsInTheWay || !turns_any(groups_[g], between)) continue;
        ++chosen[g];
        changed = true;
        draw(groups_[g], target_);
      }
      if (!changed) return false;
      next = towards_target(chosen);
    }
    const bool moved = next != at_;
    at_ = next;
    return moved;
  }

  // The largest change that is left to a group's target, degrees.
  double left(const MotionGroup& group) const {
    double most = 0;
    for (const std::size_t k : group.dofs) most = std::max(most, std::abs(target_.angles[k] - at_.angles[k]));
    for (const std::uint32_t j : group.joints) {
      most = std::max(most, length(target_.deviations[j] - at_.deviations[j]));
    }
    return most;
  }

  // Chooses the random target whose rotations lie farthest from those of the frames so far.
  void choose_target(const MotionGroup& group) {
    double farthest = -1;
    Posture best = target_, candidate = target_;
    for (int k = 0; k < kTargetCandidates; ++k) {
      draw(group, candidate);
      const double distance = squared_distance_to_covered(candidate, group, farthest);
      if (distance <= farthest) continue;
      farthest = distance;
      best = candidate;
    }
    target_ = std::move(best);
  }

  void draw(const MotionGroup& group, Posture& posture) {
    if (limits_.poses.empty() || random_.next() < kAnywhere) {
      for (const std::size_t k : group.dofs) {
        const DegreeOfFreedom& dof = limits_.dofs[k];
        posture.angles[k] = dof.min + random_.next() * (dof.max - dof.min);
      }
    } else {
      draw_between_common_poses(group, posture);
    }
    const bool deviates = random_.next() >= kWithoutDeviation;
    for (std::size_t n = 0; n < group.joints.size(); ++n) {
      const Vec3 inside = random_.in_ball();
      posture.deviations[group.joints[n]] = deviates ? group.deviations[n] * inside : Vec3{};
    }
  }

  void draw_between_common_poses(const MotionGroup& group, Posture& posture) {
    const CommonPose &a = limits_.poses[random_.below(limits_.poses.size())],
                     &b = limits_.poses[random_.below(limits_.poses.size())];
    const double t = random_.next();
    for (const std::size_t k : group.dofs) {
      const double angle = a.angles[k] + t * (b.angles[k] - a.angles[k]) + kAround * (2 * random_.next() - 1);
      posture.angles[k] = std::clamp(angle, limits_.dofs[k].min, limits_.dofs[k].max);
    }
  }

  // Sum of the squared sines of half the angles between the rotations; may stop once it is `enough` or less.
  double squared_distance_to_covered(const Posture& posture, const MotionGroup& group, double enough) const {
    const Turns turns = turns_of(posture);
    const std::size_t stride = 1 + been_.size() / kCompared;
    double nearest = 1e300;
    for (std::size_t n = been_.size(); n >= stride && nearest > enough; n -= stride) {
      double sum = 0;
      for (const std::uint32_t j : group.joints) {
        const Quat &a = turns[j], &b = been_[n - 1][j];
        const double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
        sum += std::max(0.0, 1 - cosine * cosine);
      }
      nearest = std::min(nearest, sum);
    }
    return nearest;
  }

  // One step, on the straight line to their targets, of the groups that found one.
  Posture towards_target(const std::vector<int>& chosen) const {
    Posture next = at_;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      if (chosen[g] > kTargetsInTheWay) continue;
      const double distance = left(groups_[g]), t = distance > options_.step ? options_.step / distance : 1;
      for (const std::size_t k : groups_[g].dofs) {
        next.angles[k] = t == 1 ? target_.angles[k] : at_.angles[k] + t * (target_.angles[k] - at_.angles[k]);
      }
      for (const std::uint32_t j : groups_[g].joints) {
        next.deviations[j] =
            t == 1 ? target_.deviations[j] : at_.deviations[j] + t * (target_.deviations[j] - at_.deviations[j]);
      }
    }
    return next;
  }

  static bool turns_any(const MotionGroup& group, const std::set<std::uint32_t>& joints) {
    return std::any_of(group.joints.begin(), group.joints.end(), [&](std::uint32_t j) { return joints.contains(j); });
  }

  const JointLimits& limits_;
  const Skeleton& skeleton_;
  const SelfOverlap& overlap_;
  const ExploreOptions& options_;
  UniformRandom random_;
  std::vector<MotionGroup> groups_;
  std::vector<Turns> been_;
  Posture at_, target_;
};

}  // namespace

std::vector<DofGroup> dof_groups(const JointLimits& limits) {
  const std::size_t count = limits.dofs.size();
  std::vector<std::size_t> group_of(count);
  std::iota(group_of.begin(), group_of.end(), std::size_t{0});
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = a + 1; b < count; ++b) {
      if (!any_turns(limits.dofs[a], limits.dofs[b], std::equal_to<>())) continue;
      std::replace(group_of.begin(), group_of.end(), std::size_t{group_of[b]}, std::size_t{group_of[a]});
    }
  }
  std::vector<DofGroup> groups;
  for (std::size_t name = 0; name < count; ++name) {
    DofGroup group;
    for (std::size_t k = 0; k < count; ++k) {
      if (group_of[k] == name) group.push_back(k);
    }
    if (!group.empty()) groups.push_back(group);
  }
  return groups;
}

std::vector<std::array<std::size_t, 2>> dof_pairs(const JointLimits& limits, const Skeleton& skeleton) {
  const auto neighbours = [&](std::uint32_t a, std::uint32_t b) {
    return a == b || skeleton.joints[a].parent == static_cast<int>(b) ||
           skeleton.joints[b].parent == static_cast<int>(a);
  };
  std::vector<std::array<std::size_t, 2>> pairs;
  for (std::size_t a = 0; a < limits.dofs.size(); ++a) {
    for (std::size_t b = a + 1; b < limits.dofs.size(); ++b) {
      if (any_turns(limits.dofs[a], limits.dofs[b], neighbours)) pairs.push_back({a, b});
    }
  }
  return pairs;
}

std::set<std::uint32_t> joints_between(const Skeleton& skeleton, std::uint32_t a, std::uint32_t b) {
  const auto chain = [&](std::uint32_t joint) {
    std::set<std::uint32_t> joints;
    for (int j = static_cast<int>(joint); j >= 0; j = skeleton.joints[static_cast<std::size_t>(j)].parent) {
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

std::vector<BodySphere> body_spheres(const Character& character) {
  const Positions normals = vertex_normals(character.vertices, character.triangles);
  const Eigen::Index count = character.vertices.rows(), stride = std::max<Eigen::Index>(1, count / kTouchingVertices);
  std::vector<BodySphere> touching(static_cast<std::size_t>((count + stride - 1) / stride));
  parallel_for(touching.size(), [&](std::size_t k) {
    const Eigen::Index v = static_cast<Eigen::Index>(k) * stride;
    const double size = normals.row(v).norm();
    if (!(size > 0)) return;  // in no triangle: a sphere of no radius, dropped below
    const std::uint32_t joint = character.weights[static_cast<std::size_t>(v)].front().joint;
    touching[k] = touching_sphere(character, character.vertices.row(v), normals.row(v) / size, joint);
  });

  std::vector<BodySphere> all;
  for (std::uint32_t joint = 0; joint < character.skeleton.size(); ++joint) {
    std::vector<BodySphere> own;
    for (const BodySphere& sphere : touching) {
      if (sphere.joint == joint && sphere.radius > 0) own.push_back(sphere);
    }
    const std::vector<BodySphere> kept = well_spaced(own);
    all.insert(all.end(), kept.begin(), kept.end());
  }
  return all;
}

SelfOverlap::SelfOverlap(const Character& character) : character_(character), spheres_(body_spheres(character)) {
  const Skeleton& skeleton = character.skeleton;
  std::vector<bool> fleshy(skeleton.size());
  for (const BodySphere& sphere : spheres_) fleshy[sphere.joint] = true;
  for (std::uint32_t a = 0; a < spheres_.size(); ++a) {
    for (std::uint32_t b = a + 1; b < spheres_.size(); ++b) {
      const std::uint32_t first = spheres_[a].joint, second = spheres_[b].joint;
      if (first == second || fleshy_ancestor(skeleton, fleshy, second) == static_cast<int>(first) ||
          fleshy_ancestor(skeleton, fleshy, first) == static_cast<int>(second)) {
        continue;
      }
      pairs_.push_back({a, b});
    }
  }
  trust(bind_pose(skeleton));
}

void SelfOverlap::trust(const Pose& pose) {
  const std::vector<Vec3> centres = posed_centres(pose);
  for (SpherePair& pair : pairs_) pair.trusted = std::max(pair.trusted, depth(pair, centres));
}

std::optional<std::pair<std::uint32_t, std::uint32_t>> SelfOverlap::find(const Pose& pose) const {
  const std::vector<Vec3> centres = posed_centres(pose);
  for (const SpherePair& pair : pairs_) {
    if (depth(pair, centres) > pair.trusted + kTolerance) {
      return std::make_pair(spheres_[pair.first].joint, spheres_[pair.second].joint);
    }
  }
  return std::nullopt;
}

SelfOverlap::Touch SelfOverlap::deepest(const Pose& pose) const {
  const std::vector<Vec3> centres = posed_centres(pose);
  Touch deepest{{0, 0}, -std::numeric_limits<double>::infinity()};
  for (const SpherePair& pair : pairs_) {
    const BodySphere &a = spheres_[pair.first], &b = spheres_[pair.second];
    const double part = (depth(pair, centres) - pair.trusted - kTolerance) / std::min(a.radius, b.radius);
    if (part > deepest.depth) deepest = {{a.joint, b.joint}, part};
  }
  return deepest;
}

std::vector<Vec3> SelfOverlap::posed_centres(const Pose& pose) const {
  const std::vector<Affine> skinning = skinning_matrices(character_.skeleton, pose.joints);
  return transformed(spheres_, [&](const BodySphere& sphere) { return skinning[sphere.joint] * sphere.centre; });
}

double SelfOverlap::depth(const SpherePair& pair, const std::vector<Vec3>& centres) const {
  return spheres_[pair.first].radius + spheres_[pair.second].radius -
         length(centres[pair.first] - centres[pair.second]);
}

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

Vec3 UniformRandom::in_ball() {
  Vec3 v;
  do {
    for (double& x : v) x = 2 * next() - 1;
  } while (length(v) > 1);
  return v;
}

Angles random_angles(const JointLimits& limits, UniformRandom& random) {
  Angles angles;
  for (const DegreeOfFreedom& dof : limits.dofs) angles.push_back(dof.min + random.next() * (dof.max - dof.min));
  return angles;
}

std::vector<Posture> explore(const JointLimits& limits, const Skeleton& skeleton, const SelfOverlap& overlap,
                             const std::vector<Posture>& covered, const ExploreOptions& options) {
  return Explorer(limits, skeleton, overlap, covered, options).run();
}

}  // namespace bodyopt::trainer
