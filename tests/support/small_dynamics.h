// Dynamics that are small enough to be damaged many times.
#pragma once

#include <vector>

#include "tests/support/capsule_limb.h"
#include "trainer/dynamics/build_dynamics.h"

namespace bodyopt::testing {

// The capsule limb's basis with two fibres of its flexor and a control; and dynamics in a few hundred tets.
struct SmallDynamics {
  SmallDynamics();

  Character character = limb_character();
  std::vector<Muscle> muscles = limb_muscles();
  Basis basis;
  trainer::DynamicsOptions options{.resolution = 600};
  Dynamics dynamics;
};

const SmallDynamics& small_dynamics();

// A tetrahedron that is a body: every prefix of the file of its dynamics can be tried.
struct OneTet {
  OneTet();

  Basis basis;
  Dynamics dynamics;
};

}  // namespace bodyopt::testing
