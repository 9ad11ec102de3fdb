#include "tests/support/limb_dynamics.h"

#include "runtime/host/rig.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt {

const LimbModel& limb_model() {
  static const LimbModel model = [] {
    const Character limb = limb_character();
    LimbModel made{trainer::build_ddm_basis(limb, {}), {}};
    trainer::DynamicsOptions options;
    options.resolution = 2500;
    made.dynamics = trainer::build_dynamics(limb, {}, made.basis, options).dynamics;
    return made;
  }();
  return model;
}

Dynamics limb_dynamics(const JiggleStep& step, const trainer::JiggleSettings& settings) {
  trainer::DynamicsOptions options;
  options.resolution = 2500;
  options.step = step;
  options.settings = settings;
  return trainer::build_dynamics(limb_character(), {}, limb_model().basis, options).dynamics;
}

Pose limb_pose(const LimbPose& at) {
  Pose pose = bind_pose(limb_skeleton());
  pose.joints[0].translation = at.place;
  pose.joints[0].rotation = axis_angle({0, 1, 0}, at.turn);
  pose.joints[1].rotation = axis_angle({1, 0, 0}, at.elbow);
  return pose;
}

}  // namespace bodyopt
