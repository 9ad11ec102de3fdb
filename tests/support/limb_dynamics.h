// A limb that jiggles: the synthetic limb with Direct Delta Mush alone, and dynamics of few tets.
#pragma once

#include "tests/support/capsule_limb.h"
#include "trainer/dynamics/build_dynamics.h"

namespace bodyopt {

struct LimbModel {
  Basis basis;
  Dynamics dynamics;
};

const LimbModel& limb_model();

// The same with other steps.
Dynamics limb_dynamics(const JiggleStep& step, const trainer::JiggleSettings& settings = {});

// Bends and turns, metres and radians.
struct LimbPose {
  Vec3 place{};      // of the root
  double turn = 0;   // of the root about y
  double elbow = 0;  // about x
};

Pose limb_pose(const LimbPose& at);

}  // namespace bodyopt
