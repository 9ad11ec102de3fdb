// How well a method does on frames that training never saw.
#pragma once

#include <string>
#include <vector>

#include "dataset/compare.h"
#include "runtime/basis/basis.h"
#include "trainer/train/data/samples.h"

namespace bodyopt {

struct Basis;
class Deformer;

// Marks every `every`-th block of ten consecutive simulated frames of each take as held out, and nothing else.
void hold_out_blocks(Dataset& dataset, int every);

// How frames could be held out of a set that holds out none, a sentence without a full stop: the largest `every` up to
// 5 of hold_out_blocks() that holds out something and leaves enough to train on, or another clip where takes are too
// short for any.
std::string how_to_hold_out(const SampleSet& set);

// Shapes of the held-out frames, V x 3 welded, posed: by linear blend skinning, and by a basis.
std::vector<Positions> heldout_by_lbs(const SampleSet& set);
std::vector<Positions> heldout_by_basis(const SampleSet& set, Deformer& deformer);

// Errors of such shapes against the simulation of these frames; of none, all are 0. Jitter is over consecutive frames
// of a take.
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

// RMS (mm) of what is left to learn after un-posing each shape by DDM, and by linear blend skinning, the mean over
// frames taken out of neither: over vertices and at most 200 training frames, spread evenly.
struct UnposingResidual {
  double lbs = 0, ddm = 0;
};
UnposingResidual unposing_residual(const SampleSet& set, const Basis& basis);

}  // namespace bodyopt
