// The muscles that may have a sample of lean tissue, by the distance to their paths.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "assets/characters/muscles.h"
#include "trainer/anatomy/inner_tissue.h"
#include "trainer/anatomy/muscle_paths.h"

namespace bodyopt::trainer {

// The cross-section at a share of the path, relative to the thickest: 0 on tendons.
double belly_section(const HalfMuscle& muscle, double along);

class MuscleCandidates {
 public:
  // Muscles (M), how far from its path each reaches at most (M, metres). A muscle has samples only in regions of the
  // body that its path goes through. Parts of a sheet share the fan between their paths.
  MuscleCandidates(const LeanSamples& lean, const std::vector<HalfMuscle>& muscles, const std::vector<double>& reach);

  // Measures again where paths moved a little.
  void update(const LeanSamples& lean, const std::vector<HalfMuscle>& muscles);

  // Lean sample i has the entries begin(i) to begin(i + 1).
  std::size_t begin(std::size_t lean_sample) const { return begin_[lean_sample]; }
  int muscle(std::size_t entry) const { return muscle_[entry]; }
  // Metres to the surface of a spindle about the path whose largest radius is `radius`, negative inside. Of all muscles
  // a sample goes to that with the least.
  double distance(std::size_t entry, double radius) const { return to_path_[entry] - radius * thickness_[entry]; }
  double along(std::size_t entry) const { return along_[entry]; }  // the path, 0 to 1
  // The entry of a muscle at a sample, or begin(i + 1).
  std::size_t find(std::size_t lean_sample, int muscle) const;

 private:
  std::vector<std::size_t> begin_;        // L + 1
  std::vector<std::uint16_t> muscle_;     // E
  std::vector<float> to_path_;            // E: metres
  std::vector<float> thickness_, along_;  // E: the belly's radius, of its largest; of the path, 0 to 1
  std::vector<std::vector<std::pair<int, std::size_t>>> of_muscle_;  // M: samples and their entries
};

// Muscles of the trunk and the neck, laid by the landmarks of a body's own skeleton.

struct TrunkMuscles {
  std::vector<Muscle> muscles;     // rest space; "rectus_abdominis_l", "rectus_abdominis_r" ...
  std::vector<std::string> notes;  // what could not be laid, for people
};

// The muscles of rigs/human/trunk_muscles.json, but for parts of muscles that `others` have already. Their points move
// with the nearest bones; their radii give the volumes of rigs/human/muscle_volumes.json in a body of this size.
// `body_fat`: as for the anatomy of the same body. Throws Error(mismatch) for a body without a skeleton of a human's.
TrunkMuscles trunk_muscles(const Character& character, const std::vector<Muscle>& others, double body_fat = 0.15);

}  // namespace bodyopt::trainer
