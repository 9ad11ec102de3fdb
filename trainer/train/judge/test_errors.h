// How well a basis does on frames that it may not have learned from, by area and by part of the body.
#pragma once

#include <string>
#include <vector>

#include "dataset/compare.h"
#include "runtime/basis/basis.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/fit/train.h"
#include "trainer/train/options.h"

namespace bodyopt {
struct Basis;
class Deformer;
}  // namespace bodyopt

namespace bodyopt::trainer {

// How well a method does on frames that training never saw.

// Marks every `every`-th block of ten consecutive simulated frames of each take as held out, and nothing else.
void hold_out_blocks(Dataset& dataset, int every);

// How frames could be held out of a set that holds out none, a sentence without a full stop. It names the largest
// `every` up to 5 of hold_out_blocks() that holds out something and leaves enough to train on; for short takes, another
// clip.
std::string how_to_hold_out(const SampleSet& set);

// Shapes of the held-out frames, V x 3 welded, posed: by linear blend skinning, and by a basis.
std::vector<Positions> heldout_by_lbs(const SampleSet& set);
std::vector<Positions> heldout_by_basis(const SampleSet& set, Deformer& deformer);

// Errors of such shapes against the simulation of these frames; of none, all are 0. Jitter: over frames of a take.
ErrorStatistics heldout_errors(const std::vector<Sample>& heldout, const std::vector<Positions>& shapes);

// Errors of such shapes at every vertex over the held-out frames: mean distance (mm), and mean squared distance (mm^2).
struct VertexErrors {
  Eigen::VectorXd mean, mean_square;
};
VertexErrors vertex_errors(const SampleSet& set, const std::vector<Positions>& shapes);
// RMS (mm) over the vertices of a region, by its weights.
double region_rms(const VertexErrors& errors, const RegionWeights& region);

// The basis without its residual and strains: Direct Delta Mush alone.
Basis without_residual(const Basis& basis);

// RMS (mm) of what is left to learn after un-posing each shape by DDM, and by linear blend skinning. It is over
// vertices and at most 200 training frames, spread evenly. The mean over frames is taken out of neither.
struct UnposingResidual {
  double lbs = 0, ddm = 0;
};
UnposingResidual unposing_residual(const SampleSet& set, const Basis& basis);

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

// Errors of every take on its held-out frames; of sets without any held out, on all frames. Shows progress. Throws
// Error(mismatch) where the basis is of another character.
std::vector<TakeErrors> test_errors(const Basis& basis, const SampleSet& set);
// Errors on these frames of the set.
std::vector<TakeErrors> test_errors(const Basis& basis, const SampleSet& set, const std::vector<Sample>& samples);

// Parts on which what was learned does worse than Direct Delta Mush by more than this share of it.
std::vector<PartErrors> harmed_parts(const TakeErrors& take, double share);

// The worth of each part of the model, and that of its peers: all trained and held out on the same frames.

// The first two rows and the last of the table below: linear blending, Direct Delta Mush, and `full`, trained in so
// many seconds. Needs held-out frames.
std::vector<MethodResult> compare_with_skinning(const SampleSet& set, const Basis& full, double seconds);

// `full`: what these options trained in so many seconds. The others may have as many bytes as it has, and smooth as far
// as it does. `unmade`: gets the names of those that learn nothing within these bytes. Needs held-out frames.
std::vector<MethodResult> ablate(const SampleSet& set, const TrainOptions& options, const TrainingResult& full,
                                 double seconds, std::vector<std::string>& unmade);

}  // namespace bodyopt::trainer
