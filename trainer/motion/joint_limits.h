// limits.json: the degrees of freedom of a character's joints and how far each may go.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/basis/skeleton.h"
#include "runtime/core/json.h"

namespace bodyopt::trainer {

// The effect of one degree of freedom on one joint: a turn by share x (angle - rest) about the axis.
struct JointTurn {
  std::uint32_t joint;
  Vec3 axis;         // unit; rest space: the world's axes in the bind pose
  double share = 1;  // of the angle away from rest
};

// Angles are in degrees, as anatomy tables have them.
struct DegreeOfFreedom {
  std::string name;
  double rest, min, max;  // `rest`: what the bind pose counts as
  std::vector<JointTurn> turns;
  std::string source{};  // where the numbers come from, for who edits the file
};

// How far a joint may turn by itself, about any axis: this distinguishes it from coupled joints.
struct JointDeviation {
  std::uint32_t joint;
  double degrees;        // above 0
  std::string source{};  // as of a degree of freedom
};

// A pose that the character takes often.
struct CommonPose {
  std::string name;
  std::vector<double> angles;  // one per degree of freedom, degrees, within its limits
};

// A joint that hangs elsewhere in the rig than its skin does, as feet do that inverse kinematics moves. A range of
// motion moves it as if it hung under `follows`, and its degrees of freedom turn it against that.
struct DetachedJoint {
  std::uint32_t joint, follows;
  std::string source{};  // as of a degree of freedom
};

// A joint's rotation away from the bind pose is its deviation times the product of its turns in the order of the list.
// The last is applied first.
struct JointLimits {
  std::vector<DegreeOfFreedom> dofs;
  std::vector<JointDeviation> deviations{};  // at most one for a joint
  std::vector<CommonPose> poses{};
  std::vector<DetachedJoint> detached{};
  std::string source{};  // of what holds for all of the file
};

// The deviation of joints that degrees of freedom turn, where a file says nothing.
inline constexpr double kUsualDeviation = 15;  // degrees

// Whether a joint hangs at or under another, detached ones under those that they follow. These must not close a circle.
bool hangs_under(const Skeleton& skeleton, const std::vector<DetachedJoint>& detached, std::uint32_t joint,
                 std::uint32_t above);

// A mirrored degree of freedom follows its original; mirror images of common poses follow where they differ, those of
// detached joints that are not named. Throws Error(file) for bad bytes, and Error(mismatch) for joints the skeleton
// lacks and for limits that exclude the rest pose.
JointLimits read_joint_limits(const std::filesystem::path& path, const Skeleton& skeleton);
// Reads a file's text that is in memory already; messages call it `path`.
JointLimits parse_joint_limits(std::string_view text, const std::filesystem::path& path, const Skeleton& skeleton);
void write_joint_limits(const JointLimits& limits, const Skeleton& skeleton, const std::filesystem::path& path);
Json to_json(const JointLimits& limits, const Skeleton& skeleton);  // what the file has

}  // namespace bodyopt::trainer
