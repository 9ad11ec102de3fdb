// The synthetic limb with a basis and with dynamics of few tets, and how it is waved about.
#pragma once

#include "runtime/deformer.h"
#include "tests/support/capsule_limb.h"
#include "trainer/dynamics/build_dynamics.h"

namespace bodyopt {

struct JigglingLimb {
  explicit JigglingLimb(const JiggleStep& step) {
    const SampleSet samples = limb_samples(40, 0);
    basis = train(samples, {.centres = 10});
    DynamicsOptions options;
    options.resolution = 600;
    options.step = step;
    options.settings.softness = 4;
    dynamics = build_dynamics(samples.character, samples.muscles, basis, options);
  }

  Basis basis;
  Dynamics dynamics;
};

// The limb bends and turns while all of it swings from side to side, 0.1 m, about once a second at 24 frames a second.
inline Pose waved_limb(const Skeleton& skeleton, int frame) {
  const double t = 0.25 * frame;
  Pose pose = limb_pose(skeleton, 0.5 - 0.5 * std::cos(t), 0.3 * std::sin(0.7 * t), 0.4 * std::sin(1.3 * t));
  pose.joints[0].translation = pose.joints[0].translation + Vec3{0.1 * std::sin(t), 0, 0.05 * std::cos(1.7 * t)};
  return pose;
}

}  // namespace bodyopt
