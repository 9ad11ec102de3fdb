// Which joints hold which part of the skin, by the omegas of Direct Delta Mush.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

// V: how much of each vertex those joints hold that are chosen (one flag for each joint), 0 to 1.
Eigen::VectorXd held_by(const Basis& basis, const std::vector<char>& chosen);

// Of every joint what it holds of the skin; they sum to 1. `weights`: V, >= 0, how
// much each vertex counts; all alike where all are 0.
std::vector<double> joint_shares_of(const Basis& basis, Eigen::VectorXd weights);

}  // namespace bodyopt
