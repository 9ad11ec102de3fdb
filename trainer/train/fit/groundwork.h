// The groundwork of a fit: Direct Delta Mush, fibres, features, and which regions listen to which of them.
#pragma once

#include <vector>

#include "assets/characters/character.h"
#include "runtime/basis/basis.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/data/unposed_shapes.h"
#include "trainer/train/features/features.h"
#include "trainer/train/options.h"
#include "trainer/train/regions/regions.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::trainer {

// Lists of features from which a region may choose one.
using FeatureChoices = std::vector<std::vector<std::uint32_t>>;

struct Layout {
  std::vector<RegionWeights> regions;   // runtime order
  std::vector<FeatureChoices> choices;  // of every region
};

// Features that an earlier training measured with Direct Delta Mush of some radius.
struct EarlierFeatures {
  double smoothing_radius = 0;  // metres
  KnownFeatures features;
};

// Everything in runtime order. Members refer to each other: it stays where it is.
struct Groundwork {
  // `curves`: on the surface, that stand beside the set's muscles.
  Groundwork(const SampleSet& set, const TrainOptions& options, const std::vector<Muscle>& curves = {},
             const EarlierFeatures& earlier = {});
  Groundwork(const Groundwork&) = delete;
  Groundwork& operator=(const Groundwork&) = delete;

  std::vector<Muscle> muscles;       // whose fibres the base has: the set's, then the curves
  std::size_t curve_count;           // of them
  std::vector<std::uint32_t> order;  // welded vertex of each runtime vertex
  Character ordered;
  DdmBase base;  // with fibres
  UnposedShapes shapes;
  FeatureSamples features;
};

// Un-poses 800 frames at most, spread evenly: on these influences are measured. Curves without any muscle beside them
// shape no region. Shows progress.
Layout make_layout(const SampleSet& set, const Groundwork& ground, const Method& method);

}  // namespace bodyopt::trainer
