#include "trainer/motion/fit_angles.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <set>

#include "trainer/motion/dof_groups.h"

namespace bodyopt {
namespace {

constexpr int kIterations = 20;
constexpr double kDifference = 1e-3;  // degrees
constexpr double kEnough = 1e-6;      // degrees

// One group of degrees of freedom and the joints they turn.
class GroupFit {
 public:
  GroupFit(const JointLimits& limits, const DofGroup& group, std::size_t joint_count) : joint_count_(joint_count) {
    std::set<std::uint32_t> joints;
    for (const std::size_t k : group) {
      limits_.dofs.push_back(limits.dofs[k]);
      for (const JointTurn& turn : limits.dofs[k].turns) joints.insert(turn.joint);
    }
    joints_.assign(joints.begin(), joints.end());
  }

  // Nearest within the limits, from `start`.
  Angles fit(const std::vector<Quat>& wanted, Angles start) const {
    Angles best = start;
    Eigen::VectorXd error = errors(wanted, best);
    double damping = 1e-3;
    for (int round = 0; round < kIterations; ++round) {
      const Angles next = improved(wanted, best, error, damping);
      const Eigen::VectorXd next_error = errors(wanted, next);
      if (next_error.squaredNorm() < error.squaredNorm()) {
        const bool done = (next_error - error).cwiseAbs().maxCoeff() < kEnough;
        best = next;
        error = next_error;
        damping *= 0.1;
        if (done) break;
      } else {
        damping *= 10;
      }
    }
    return best;
  }

 private:
  // Rotation vectors from the wanted rotations, degrees, three per joint.
  Eigen::VectorXd errors(const std::vector<Quat>& wanted, const Angles& angles) const {
    const std::vector<Quat> turns = joint_turns(joint_count_, limits_, angles);
    Eigen::VectorXd all(3 * static_cast<Eigen::Index>(joints_.size()));
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      const Quat off = conjugate(wanted[joints_[j]]) * turns[joints_[j]];
      const double sine = std::sqrt(off[0] * off[0] + off[1] * off[1] + off[2] * off[2]);
      const double scale = (off[3] < 0 ? -1 : 1) * (sine > 1e-12 ? angle_of(off) / sine : 0);
      for (int i = 0; i < 3; ++i) all(3 * static_cast<Eigen::Index>(j) + i) = scale * off[static_cast<std::size_t>(i)];
    }
    return all;
  }

  Angles improved(const std::vector<Quat>& wanted, const Angles& at, const Eigen::VectorXd& error,
                  double damping) const {
    const Eigen::Index count = static_cast<Eigen::Index>(at.size());
    Eigen::MatrixXd jacobian(error.size(), count);
    for (Eigen::Index k = 0; k < count; ++k) {
      Angles moved = at;
      moved[static_cast<std::size_t>(k)] += kDifference;
      jacobian.col(k) = (errors(wanted, moved) - error) / kDifference;
    }
    Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
    normal.diagonal().array() += damping;
    const Eigen::VectorXd step = normal.ldlt().solve(jacobian.transpose() * error);
    Angles next = at;
    for (std::size_t k = 0; k < at.size(); ++k) {
      next[k] = std::clamp(at[k] - step(static_cast<Eigen::Index>(k)), limits_.dofs[k].min, limits_.dofs[k].max);
    }
    return next;
  }

  std::size_t joint_count_;
  JointLimits limits_;
  std::vector<std::uint32_t> joints_;
};

}  // namespace

std::vector<Angles> fit_angles(const Clip& clip, const JointLimits& limits, const Skeleton& skeleton) {
  std::vector<std::vector<Quat>> wanted;
  for (const Pose& pose : clip.poses) wanted.push_back(turns_of_pose(skeleton, pose));
  std::vector<Angles> frames(clip.poses.size(), rest_angles(limits));
  for (const DofGroup& group : dof_groups(limits)) {
    const GroupFit fit(limits, group, skeleton.size());
    Angles angles;
    for (const std::size_t k : group) angles.push_back(limits.dofs[k].rest);
    for (std::size_t f = 0; f < frames.size(); ++f) {
      angles = fit.fit(wanted[f], angles);
      for (std::size_t k = 0; k < group.size(); ++k) frames[f][group[k]] = angles[k];
    }
  }
  return frames;
}

}  // namespace bodyopt
