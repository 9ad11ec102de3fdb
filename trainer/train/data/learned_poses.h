// The poses that a basis learned from, so that a test can tell whether it is given them again.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runtime/basis/basis.h"
#include "trainer/train/data/samples.h"

namespace bodyopt::trainer {

constexpr const char* kLearnedPoses = "learned_poses";  // of a basis' metadata

// All training frames, as the metadata has them: eight hexadecimal digits of each pose, ascending, without gaps. What
// counts is what was learned from: how joints that bend the skin are turned, and controls, to 1e-4. Poses that differ
// there have other digits, but for one pair of 4 billion. So have two poses with a number just below and just above
// where it is rounded.
std::string learned_poses_text(const SampleSet& set);

// Whether it says which poses it learned from: older ones, carried ones and those of Direct Delta Mush alone do not.
bool tells_learned_poses(const Basis& basis);

class LearnedPoses {
 public:
  // None, of a basis that does not tell. `set`: of the basis' character.
  LearnedPoses(const Basis& basis, const SampleSet& set);
  // Whether a pose, with the controls of the set, is one that was learned from.
  bool has(const Pose& pose) const;

 private:
  const SampleSet& set_;
  std::vector<std::uint32_t> joints_;  // by which a pose is recognised
  std::vector<std::string> poses_;     // ascending
};

}  // namespace bodyopt::trainer
