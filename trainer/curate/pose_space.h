// How far poses are apart, to a part of the skin: by the joints that move it, and by controls.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "assets/character.h"

namespace bodyopt {

// Of the joints that bend skin those with 5 % of the skin of a mask (V) or more; where there are none, all of them.
std::vector<std::uint32_t> joints_moving(const Character& character, const Eigen::VectorXd& mask);

// Indices of joints. Throws Error(mismatch) at an unknown name, with those nearest to it.
std::vector<std::uint32_t> joints_named(const Skeleton& skeleton, const std::vector<std::string>& names,
                                        const std::string& place);

// From one pose to another: three radians per joint, the rotation between both, as axis times angle, in its own axes.
Eigen::VectorXd turns_between(const Pose& from, const Pose& to, const std::vector<std::uint32_t>& joints);

// The same, and the controls, a unit of which counts as a radian.
Eigen::VectorXd pose_difference(const Pose& from, const Pose& to, const std::vector<std::uint32_t>& joints);

// Whether that is shorter than `reach` radians; quickly.
bool is_near(const Pose& from, const Pose& to, const std::vector<std::uint32_t>& joints, double reach);

// The length of that, degrees.
double pose_distance(const Pose& from, const Pose& to, const std::vector<std::uint32_t>& joints);

}  // namespace bodyopt
