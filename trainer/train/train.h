// From a dataset to a basis.
#pragma once

#include <filesystem>

#include "assets/character.h"
#include "dataset/dataset.h"
#include "geometry/region_weights.h"
#include "runtime/basis/basis.h"
#include "trainer/train/sample_shape.h"

namespace bodyopt {

// The full model, and what is left out of it to see what each part is worth.
struct Method {
  enum class Unposing { ddm, lbs };                                    // lbs: only for evaluation by heldout_by_basis
  enum class Support { whole_skin, static_regions, dynamic_regions };  // dynamic: by what muscles do, too
  Unposing unposing = Unposing::ddm;
  Support support = Support::dynamic_regions;
  bool strains = true;
  bool kernels = true;  // without: a linear map
};

struct TrainOptions {
  // DDM sigma, metres; 0: 0.025 x the size of the character (0.045 for 1.8 m) or twice that, whichever leaves less to
  // learn on the training frames.
  double smoothing_radius = 0;
  int smoothing_steps = 20;  // DDM p
  int components = 32;       // coefficients per region at most
  int centres = 256;         // kernel centres per region at most
  double memory_gib = 4;  // un-posed motion takes about half of it, one region's at least; a pass over all frames for
                          // every part of the skin that fits
  std::uint64_t seed = 1;
  Method method{};
  // How large the basis is to be, one of them at most; without, as large as is worth it.
  double budget = 0;        // bytes of all tables per vertex at most
  double tolerance_mm = 0;  // as small as its expected error allows
  int surface_curves = 0;   // pairs of them, see surface_curves.h
  // A folder for what is found, from which a training of the same data and options goes on where it stopped; empty:
  // nothing is kept.
  std::filesystem::path keep_in{};
  // Bring what an earlier training kept there to these frames, where no more than a tenth of them are others;
  // otherwise, and where nothing fits, train from the start.
  bool update = false;
};

// One training or held-out frame.
struct Sample {
  int take = 0;
  int frame = 0;
  Pose pose;
  SampleShape shape;
};

// The dataset, split; shapes stay on disk. Unconverged frames are left out and counted.
struct SampleSet {
  Character character;
  std::vector<Muscle> muscles;
  std::vector<std::string> takes;      // names, by Sample::take
  std::vector<std::string> controls;   // of every pose, by name
  std::vector<RegionWeights> regions;  // painted: as read_regions
  std::vector<Sample> train, heldout;
  int unconverged = 0;
  bool sparse = false;  // neighbours lie far apart and move apart, as on a proxy: none of them is held to be stray
  std::vector<std::string> notes;
};
SampleSet read_samples(const Dataset& dataset);

// "frame 12 of take 'rom'".
std::string frame_name(const SampleSet& set, const Sample& sample);

// DDM, no shapes: mesh and ddm tables, an empty residual.
Basis build_ddm_basis(const Character& character, const TrainOptions& options);

// Throws Error(mismatch) where there are too few training frames, or one has a number that is not finite.
void check_samples(const SampleSet& set);

// The regions that train() would fit: those painted, and those chosen. A partition of unity on welded vertices, each
// with a name of its own. Shows progress. Throws as train().
std::vector<RegionWeights> training_regions(const SampleSet& set, const TrainOptions& options);

// The full training. Never looks at set.heldout. Shows progress. Throws Error(mismatch) when there is too little data,
// or where it is not sound, Error(file) where what is kept cannot be read or written. `notes`: gets what
// the user should know of an update.
Basis train(const SampleSet& set, const TrainOptions& options, std::vector<std::string>* notes = nullptr);

// What train() has to say of the data, one sentence each, for the user: shapes that contradict each other, stray
// vertices, controls that never change, too few frames.
std::vector<std::string> training_warnings(const Basis& basis);

// RMS (mm) of what is left to learn after un-posing each shape by DDM, and by linear blend skinning, the mean over
// frames taken out of neither: over vertices and at most 200 training frames, spread evenly.
struct UnposingResidual {
  double lbs = 0, ddm = 0;
};
UnposingResidual unposing_residual(const SampleSet& set, const Basis& basis);

// Linear blend skinning, double precision, V x 3 welded; the baseline "lbs".
Positions skin_linear(const Character& character, const Pose& pose);

}  // namespace bodyopt
