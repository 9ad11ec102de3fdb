// The poses that a basis learned from, so that a test can tell whether it is given them again.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runtime/basis/basis.h"
#include "trainer/train/data/samples.h"

namespace bodyopt {

constexpr const char* kLearnedPoses = "learned_poses";  // of a basis' metadata

// Of all training frames, as the metadata has them: eight hexadecimal digits of each pose, ascending, without gaps.
// Two that differ anywhere differ there, but for one of 4 billion.
std::string learned_poses_text(const SampleSet& set);

class LearnedPoses {
 public:
  explicit LearnedPoses(const Basis& basis);  // none, of a basis that does not tell
  // Whether a frame of the set has the joints and the controls of a pose that was learned from.
  bool has(const SampleSet& set, const Pose& pose) const;

 private:
  std::vector<std::string> poses_;  // ascending
};

}  // namespace bodyopt
