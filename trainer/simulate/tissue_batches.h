// Tets eight by eight, as their forces are found in lanes.
#pragma once

#include <span>
#include <vector>

#include "trainer/simulate/muscle_fibres.h"

namespace bodyopt::trainer {

constexpr int kTetLanes = 8;

// Eight tets side by side. Empty lanes have no volume.
struct TetBatch {
  int node[4][kTetLanes];         // three times each: where its coordinates begin
  double slope[3][3][kTetLanes];  // gradient of the shape functions of corners 1..3, 1/m; corner 0: minus their sum
  double volume[kTetLanes], mu[kTetLanes], lambda[kTetLanes];
};
struct FibreBatch {
  double slope[3][kTetLanes];  // the same slopes along the fibre
  double volume[kTetLanes];    // zero in lanes without fibres
  int muscle[kTetLanes];
};
// Fibres of muscles that share their tets with others.
struct FurtherFibres {
  int node[4][kTetLanes];
  FibreBatch fibres;
};

struct TissueBatches {
  std::vector<TetBatch> tets;
  std::vector<FibreBatch> fibres;  // of the first batches of tets
  std::vector<FurtherFibres> further;
  double active, passive;  // stiffness of fibres, Pa
};

struct TissueSum {
  double energy = 0;        // joules
  double force_square = 0;  // N^2: over all tets, the squared forces each puts on its four nodes
};

// Eight numbers of each: what the barrier adds where tets are pressed below its volume.
struct BatchStress {
  double volume_ratio[kTetLanes];  // J
  double pressure[kTetLanes];      // dPsi/dJ, Pa
  double density[kTetLanes];       // Psi, Pa
};
// least_volume: cubic metres.
void add_barrier(const TetBatch& batch, double steepest, double least_volume, BatchStress& stress);

// Adds the gradient of Tissue's energy at `nodes` (N x 3) to `gradient`. The same bits with any instructions.
TissueSum add_tissue_forces(const TissueBatches& tissue, const double* nodes, std::span<const FibreDrive> drives,
                            double steepest, double least_volume, double* gradient);
// J of each tet of a batch.
void find_volume_ratios(const TetBatch& batch, const double* nodes, double (&ratios)[kTetLanes]);

}  // namespace bodyopt::trainer
