// Builds the dynamics of a character and its trained basis.
#pragma once

#include <string>

#include "assets/characters/character.h"
#include "assets/characters/muscles.h"
#include "geometry/region_weights.h"
#include "runtime/basis/dynamics.h"
#include "trainer/anatomy/field.h"
#include "trainer/dynamics/dynamics_tets.h"
#include "trainer/dynamics/jiggle_settings.h"
#include "trainer/simulate/materials.h"

namespace bodyopt::trainer {

// Says where the skin is open, fused, turned or passes through itself: the joints that move it there, and a vertex of
// theirs (rest space). Example: "; the skin is open at 'Head' (0.012 1.633 0.101 m)". Empty for a sound skin.
std::string defect_places(const Character& character);

struct DynamicsOptions {
  Eigen::Index resolution = 25000;  // tets at most
  JiggleStep step{};                // stiffness_damping is found from the settings
  JiggleSettings settings{};
  Materials materials{};  // tissues and bone springs
  AnatomyOptions anatomy{};
  std::vector<RegionWeights> painted{};  // of welded vertices, as read_regions gives them: what settings may name
  // Diffuse is not to turn tets inside out in these, whose controls are the basis'. Of many poses it checks some.
  std::vector<Pose> poses{};
};

// The findings of build_dynamics().
struct DynamicsReport {
  std::uint32_t tets = 0, nodes = 0, surface_nodes = 0;
  TetQuality quality;
  Unfolding inverted_tets;
  std::size_t bone_springs = 0, joints_with_bones = 0;
  std::vector<std::string> notes;  // what the user should know, one sentence each
};
// Returns it as the metadata "report" of the dynamics has it.
Json to_json(const DynamicsReport& report);

struct BuiltDynamics {
  Dynamics dynamics;
  DynamicsReport report;
  JiggleSettings settings;  // that it was built with, what they left open as it was chosen
};

// Tets, diffuse and jiggle; their metadata hold report and settings, too. Throws Error(mismatch) where the basis is of
// another character, the skin cannot be filled or the settings name what is not there. Throws Error(usage) for settings
// or steps out of range. Shows progress; throws Error(interrupted) after SIGINT, at the end of a step.
BuiltDynamics build_dynamics(const Character& character, const std::vector<Muscle>& muscles, const Basis& basis,
                             const DynamicsOptions& options);

// Returns the tets and steps that dynamics were built for, and the settings as they were given. What those left open is
// open. Throws Error(file) where the metadata do not say.
DynamicsOptions asked_options(const Dynamics& dynamics);

}  // namespace bodyopt::trainer
