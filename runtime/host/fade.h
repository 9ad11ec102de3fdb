// How much of what was learned holds in a pose. Runs on the host, as the rig stage: a few numbers per joint and frame.
#pragma once

#include <span>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

// How far each joint is off training: max(0, off_j^2 - tolerance_j) of FadeTable, radians squared, in the order of
// feature_joints(). `joint_features`: of one frame, see RigFrame. Empty without a FadeTable. `off`: memory that is used
// again.
std::vector<double> joints_off(const ResidualTable& residual, std::span<const float> joint_features,
                               std::vector<double> off = {});

// fade_r of every region, see FadeTable: 1 where the pose is like those of training, towards 0 away from them.
std::vector<float> region_fades(const ResidualTable& residual, std::span<const float> joint_features);
void region_fades(const ResidualTable& residual, std::span<const double> joints_off, std::span<float> fades);

// The joint (in the order of feature_joints()) that takes most from all regions together; -1 where nothing fades.
// taken: scratch.
int fading_joint(const ResidualTable& residual, std::span<const double> joints_off, std::vector<double>& taken);

}  // namespace bodyopt
