// How far poses are apart, to a part of the skin: by the joints that move it, and by controls.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "trainer/curate/local_models.h"

namespace bodyopt::trainer {

// The joints that bend skin and have 5 % of the skin of a mask (V) or more; where none has, all that bend skin.
std::vector<std::uint32_t> joints_moving(const Character& character, const Eigen::VectorXd& mask);

// Indices of joints. Throws Error(mismatch) at an unknown name, with those nearest to it.
std::vector<std::uint32_t> joints_named(const Skeleton& skeleton, const std::vector<std::string>& names,
                                        const std::string& place);

// The rotation of each joint from one pose to another, as axis times angle (three radians), in the joint's own axes.
Eigen::VectorXd turns_between(const Pose& from, const Pose& to, const std::vector<std::uint32_t>& joints);

// Appends the differences of controls, a unit of which counts as a radian, to turns_between().
Eigen::VectorXd pose_difference(const Pose& from, const Pose& to, const std::vector<std::uint32_t>& joints);

// Whether that is shorter than `reach` radians; quickly.
bool is_near(const Pose& from, const Pose& to, const std::vector<std::uint32_t>& joints, double reach);

// The length of that, degrees.
double pose_distance(const Pose& from, const Pose& to, const std::vector<std::uint32_t>& joints);

// The poses of a database as points of a plane. It spans the two directions in which controls and the joints that move
// a part of the skin vary most.
struct PoseMap {
  Eigen::MatrixX2d places;      // N, degrees, around their mean
  std::vector<int> neighbours;  // N: other frames whose poses are near
};

// Root mean square distance of poses from their mean, in all directions, degrees.
double pose_spread(const PoseDatabase& database, const SkinPart& part);

// `degrees`: how far poses are near.
PoseMap pose_map(const PoseDatabase& database, const SkinPart& part, double degrees);

}  // namespace bodyopt::trainer
