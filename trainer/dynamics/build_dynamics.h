// From a character and its trained basis to its dynamics.
#pragma once

#include "assets/character.h"
#include "assets/muscles.h"
#include "geometry/region_weights.h"
#include "runtime/basis/dynamics.h"
#include "trainer/dynamics/jiggle_settings.h"
#include "trainer/simulate/materials.h"

namespace bodyopt {

struct DynamicsOptions {
  Eigen::Index resolution = 25000;  // tets at most
  JiggleStep step{};                // stiffness_damping is found from the settings
  JiggleSettings settings{};
  Materials materials{};                 // fat, muscle and bone springs
  std::vector<RegionWeights> painted{};  // of welded vertices, as read_regions gives them: what settings may name
  // With the basis' controls. Diffuse is not to turn tets inside out in these; of many, some are looked at.
  std::vector<Pose> poses{};
};

// Tets, diffuse and jiggle, with a report in the metadata (tets, nodes, quality, unfolding, springs, notes). Throws
// Error(mismatch) where the basis is of another character, the skin cannot be filled or the settings name what is not
// there, Error(usage) for settings or steps that make no sense. Shows
// progress; throws Error(interrupted) after SIGINT, at the end of a step.
Dynamics build_dynamics(const Character& character, const std::vector<Muscle>& muscles, const Basis& basis,
                        const DynamicsOptions& options);

// What it was built for: the tets and steps that were asked for, and the settings as they were given, open where they
// left something open. Throws Error(file) where its metadata do not say.
DynamicsOptions asked_options(const Dynamics& dynamics);

// The settings that it was built with, what they left open as it was chosen: a jiggle.json to edit.
nlohmann::ordered_json chosen_jiggle(const Dynamics& dynamics);

// What of it the user should know, one sentence each.
std::vector<std::string> dynamics_notes(const Dynamics& dynamics);

}  // namespace bodyopt
