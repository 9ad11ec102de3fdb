// How well a basis does on frames that it may not have learned from, by area and by part of the body.
#pragma once

#include <string>
#include <vector>

#include "runtime/basis/basis.h"
#include "trainer/train/data/samples.h"

namespace bodyopt {

// RMS over frames and an area of the rest skin, mm.
struct MethodErrors {
  double ddm = 0;       // Direct Delta Mush alone
  double full = 0;      // all that was learned
  double expected = 0;  // what the basis itself expects of `full`; 0 where it was trained without shapes
};

struct PartErrors {
  std::string part;  // a joint, whose skin it is: by area and skin weights
  double area = 0;   // square metres at rest
  MethodErrors errors;
};

struct FrameErrors {
  int frame = 0;
  MethodErrors errors;
  double fade = 1;           // how much is left of what was learned, the mean over its regions
  std::string fading_joint;  // that takes most of it; none: nothing fades
  bool learned = false;      // the basis learned from this pose, as far as it tells
};

struct TakeErrors {
  std::string take;
  MethodErrors errors;            // of the whole skin
  std::vector<PartErrors> parts;  // of all joints that have skin
  std::vector<FrameErrors> frames;
  double rank_correlation = 0;  // Spearman's, of expected and true errors of every frame and part
};

// Of every take that has frames held out those frames; of sets without any held out all of them. Shows progress.
// Throws Error(mismatch) where the basis is of another character.
std::vector<TakeErrors> test_errors(const Basis& basis, const SampleSet& set);
// The same of these frames of the set.
std::vector<TakeErrors> test_errors(const Basis& basis, const SampleSet& set, const std::vector<Sample>& samples);

// Parts on which what was learned does worse than Direct Delta Mush by more than this share of it.
std::vector<PartErrors> harmed_parts(const TakeErrors& take, double share);

}  // namespace bodyopt
