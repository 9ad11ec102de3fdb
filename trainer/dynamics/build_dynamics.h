// From a character and its trained basis to its dynamics.
#pragma once

#include <string>

#include "assets/character.h"
#include "assets/muscles.h"
#include "geometry/region_weights.h"
#include "runtime/basis/dynamics.h"
#include "trainer/anatomy/field.h"
#include "trainer/dynamics/dynamics_tets.h"
#include "trainer/dynamics/jiggle_settings.h"
#include "trainer/simulate/materials.h"

namespace bodyopt {

// "; the skin is open at 'Head' (0.012 1.633 0.101 m)": where it is open, fused, turned or passes through itself, each
// by the joints that move it there and a vertex (rest space) of theirs. Empty where it is nothing of this.
std::string defect_places(const Character& character);

struct DynamicsOptions {
  Eigen::Index resolution = 25000;  // tets at most
  JiggleStep step{};                // stiffness_damping is found from the settings
  JiggleSettings settings{};
  Materials materials{};  // tissues and bone springs
  AnatomyOptions anatomy{};
  std::vector<RegionWeights> painted{};  // of welded vertices, as read_regions gives them: what settings may name
  // With the basis' controls. Diffuse is not to turn tets inside out in these; of many, some are looked at.
  std::vector<Pose> poses{};
};

// What was found on the way.
struct DynamicsReport {
  std::uint32_t tets = 0, nodes = 0, surface_nodes = 0;
  TetQuality quality;
  Unfolding inverted_tets;
  std::size_t bone_springs = 0, joints_with_bones = 0;
  std::vector<std::string> notes;  // what the user should know, one sentence each
};
// As the metadata "report" of the dynamics.
Json to_json(const DynamicsReport& report);

struct BuiltDynamics {
  Dynamics dynamics;
  DynamicsReport report;
  JiggleSettings settings;  // that it was built with, what they left open as it was chosen
};

// Tets, diffuse and jiggle; their metadata hold report and settings, too. Throws Error(mismatch) where the basis is of
// another character, the skin cannot be filled or the settings name what is not there, Error(usage) for settings or
// steps that make no sense. Shows progress; throws Error(interrupted) after SIGINT, at the end of a step.
BuiltDynamics build_dynamics(const Character& character, const std::vector<Muscle>& muscles, const Basis& basis,
                             const DynamicsOptions& options);

// What it was built for: the tets and steps that were asked for, and the settings as they were given, open where they
// left something open. Throws Error(file) where its metadata do not say.
DynamicsOptions asked_options(const Dynamics& dynamics);

}  // namespace bodyopt
