// What was carried to a body, moved to what that body's own frames show.
#pragma once

#include <memory>
#include <set>
#include <string>

#include "runtime/deformer/deformer.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/options.h"

namespace bodyopt {

// The modifier in a dataset's stack that holds what refining made of a carried take.
std::string refinement_of(const std::string& take);

// A cheap model of much and a dear one of little (Kennedy and O'Hagan 2000): the carried frames are learned; then what
// the body's own frames differ by from that, which is less and changes less with the pose than they do, so that few
// tell it. Where the own frames know nothing, what was carried stays.
class RefinedShapes {
 public:
  // `carried`: names of takes of the set; all its other training frames are the body's own. Shows progress. Throws
  // Error(usage) for a take that the set does not have, Error(mismatch) where either kind has too few frames, and as
  // train().
  RefinedShapes(SampleSet set, const std::set<std::string>& carried, const TrainOptions& options);

  // O x 3, posed, metres, world.
  std::vector<float> operator()(const Pose& pose);
  // What the own frames were off what was carried, root mean square over vertices, millimetres.
  double difference_mm() const { return difference_mm_; }

 private:
  std::vector<float> of(Deformer& deformer, const Pose& pose) const;

  std::unique_ptr<Deformer> carried_, bare_, own_;  // as learned; its Direct Delta Mush; that with what own frames add
  double difference_mm_ = 0;
};

}  // namespace bodyopt
