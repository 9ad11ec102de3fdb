#include "trainer/simulate/tissue.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "trainer/simulate/tissue_forces.cpp"
#include "hwy/foreach_target.h"
// The code below it is compiled again for each set of instructions.
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace bodyopt::trainer::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A group is as many of a batch's eight tets as registers hold; the caller goes over these groups. Nothing is fused, so
// that all instructions round alike.
using TetTag = hn::CappedTag<double, kTetLanes>;
using Number = hn::Vec<TetTag>;
constexpr int kGroup = static_cast<int>(hn::MaxLanes(TetTag()));
using Index = hn::Vec<hn::RebindToSigned<TetTag>>;

HWY_INLINE Number load(const double* from) { return hn::LoadU(TetTag(), from); }
HWY_INLINE void store(Number number, double* to) { hn::StoreU(number, TetTag(), to); }
HWY_INLINE Number number(double value) { return hn::Set(TetTag(), value); }
HWY_INLINE Index load_index(const int* from) {
  return hn::PromoteTo(hn::RebindToSigned<TetTag>(), hn::LoadU(hn::Rebind<int, TetTag>(), from));
}

// Edge vectors from corner 0 to corners 1..3.
struct Corners {
  Number edge[3][3];  // corner, axis
};

HWY_INLINE Corners corners_of(const int (&node)[4][kTetLanes], int group, const double* nodes) {
  Corners corners;
  Number origin[3];
  for (int a = 0; a < 4; ++a) {
    const Index index = load_index(node[a] + group);
    for (int i = 0; i < 3; ++i) {
      const Number at = hn::GatherIndex(TetTag(), nodes + i, index);
      if (a == 0) {
        origin[i] = at;
      } else {
        corners.edge[a - 1][i] = at - origin[i];
      }
    }
  }
  return corners;
}

struct Strain {
  Number f[3][3];         // deformation gradient
  Number cofactor[3][3];  // dJ/dF
  Number volume_ratio;    // J
};

HWY_INLINE Strain strain_of(const TetBatch& batch, int group, const Corners& corners) {
  Strain s;
  for (int k = 0; k < 3; ++k) {
    const Number slope[3] = {load(batch.slope[0][k] + group), load(batch.slope[1][k] + group),
                             load(batch.slope[2][k] + group)};
    for (int i = 0; i < 3; ++i) {
      s.f[i][k] = corners.edge[0][i] * slope[0] + corners.edge[1][i] * slope[1] + corners.edge[2][i] * slope[2];
    }
  }
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int k = 0; k < 3; ++k) {
      const int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
      s.cofactor[i][k] = s.f[i1][k1] * s.f[i2][k2] - s.f[i1][k2] * s.f[i2][k1];
    }
  }
  s.volume_ratio = s.f[0][0] * s.cofactor[0][0] + s.f[0][1] * s.cofactor[0][1] + s.f[0][2] * s.cofactor[0][2];
  return s;
}

// The pull on corners 1..3, kept for all groups of a batch, and sums over tets, a lane each.
struct Forces {
  double pull[3][3][kTetLanes];  // corner, axis
};
struct LaneSums {
  double energy[kTetLanes] = {}, force_square[kTetLanes] = {};
};

HWY_INLINE void add(Number number, double* to) { store(load(to) + number, to); }

// Adds to the forces.
HWY_INLINE void pull_fibres(const TissueBatches& tissue, const FibreBatch& batch, int group, const Corners& corners,
                            const FibreDrive* drives, Number (&force)[3][3], LaneSums& sums) {
  static_assert(sizeof(FibreDrive) == 2 * sizeof(double));
  const Number slope[3] = {load(batch.slope[0] + group), load(batch.slope[1] + group), load(batch.slope[2] + group)};
  Number along[3];
  for (int i = 0; i < 3; ++i) {
    along[i] = corners.edge[0][i] * slope[0] + corners.edge[1][i] * slope[1] + corners.edge[2][i] * slope[2];
  }
  const Number stretch = hn::Sqrt(along[0] * along[0] + along[1] * along[1] + along[2] * along[2]);
  const Index drive = hn::ShiftLeft<1>(load_index(batch.muscle + group));
  const Number activation = hn::GatherIndex(TetTag(), &drives->activation, drive);
  const Number slack = hn::GatherIndex(TetTag(), &drives->slack, drive);
  const Number zero = number(0), volume = load(batch.volume + group);
  const Number active = hn::Max(stretch - slack, zero), passive = hn::Max(stretch - number(1), zero);
  const Number active_stress = activation * number(tissue.active) * active;
  const Number passive_stress = number(tissue.passive) * passive;
  add(volume * number(0.5) * (active_stress * active + passive_stress * passive), sums.energy + group);
  const Number pull = volume * (active_stress + passive_stress) / hn::Max(stretch, number(1e-12));
  for (int a = 0; a < 3; ++a) {
    for (int i = 0; i < 3; ++i) force[a][i] = force[a][i] + pull * slope[a] * along[i];
  }
}

HWY_INLINE void keep(const Number (&force)[3][3], int group, Forces& forces, LaneSums& sums) {
  Number square = number(0);
  for (int i = 0; i < 3; ++i) {
    const Number origin = force[0][i] + force[1][i] + force[2][i];
    square = square + origin * origin;
    for (int a = 0; a < 3; ++a) {
      square = square + force[a][i] * force[a][i];
      store(force[a][i], forces.pull[a][i] + group);
    }
  }
  add(square, sums.force_square + group);
}

// Adds to the gradient what corners 1..3 are pulled with, and its opposite to corner 0.
HWY_INLINE void scatter(const int (&node)[4][kTetLanes], const Forces& forces, double* gradient) {
  for (int lane = 0; lane < kTetLanes; ++lane) {
    double* const origin = gradient + node[0][lane];
    double* const corner[3] = {gradient + node[1][lane], gradient + node[2][lane], gradient + node[3][lane]};
    for (int i = 0; i < 3; ++i) {
      const double a = forces.pull[0][i][lane], b = forces.pull[1][i][lane], c = forces.pull[2][i][lane];
      corner[0][i] += a;
      corner[1][i] += b;
      corner[2][i] += c;
      origin[i] -= a + b + c;
    }
  }
}

HWY_INLINE void add_batch(const TissueBatches& tissue, std::size_t b, const double* nodes, const FibreDrive* drives,
                          double steepest, double least_volume, Forces& forces, LaneSums& sums) {
  const TetBatch& batch = tissue.tets[b];
  Corners corners[kTetLanes / kGroup];
  Strain strain[kTetLanes / kGroup];
  BatchStress stress;
  bool is_pressed = false;
  for (int g = 0; g < kTetLanes / kGroup; ++g) {
    const int group = g * kGroup;
    corners[g] = corners_of(batch.node, group, nodes);
    strain[g] = strain_of(batch, group, corners[g]);
    const Strain& s = strain[g];
    const Number mu = load(batch.mu + group), lambda = load(batch.lambda + group), rest = mu / lambda;
    const Number beyond = s.volume_ratio - number(1) - rest;
    Number square = number(0);
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) square = square + s.f[i][k] * s.f[i][k];
    }
    store(s.volume_ratio, stress.volume_ratio + group);
    store(lambda * beyond, stress.pressure + group);
    store(number(0.5) * (mu * (square - number(3)) + lambda * (beyond * beyond - rest * rest)), stress.density + group);
    is_pressed |= !hn::AllFalse(TetTag(), hn::Lt(s.volume_ratio, number(Tissue::kBarrierVolume)));
  }
  if (is_pressed) add_barrier(batch, steepest, least_volume, stress);
  for (int g = 0; g < kTetLanes / kGroup; ++g) {
    const int group = g * kGroup;
    const Strain& s = strain[g];
    const Number mu = load(batch.mu + group), volume = load(batch.volume + group);
    const Number pressure = load(stress.pressure + group);
    add(volume * load(stress.density + group), sums.energy + group);
    Number force[3][3];
    for (int i = 0; i < 3; ++i) {
      Number row[3];  // of the first Piola-Kirchhoff stress
      for (int k = 0; k < 3; ++k) row[k] = volume * (mu * s.f[i][k] + pressure * s.cofactor[i][k]);
      for (int a = 0; a < 3; ++a) {
        force[a][i] = row[0] * load(batch.slope[a][0] + group) + row[1] * load(batch.slope[a][1] + group) +
                      row[2] * load(batch.slope[a][2] + group);
      }
    }
    if (b < tissue.fibres.size()) pull_fibres(tissue, tissue.fibres[b], group, corners[g], drives, force, sums);
    keep(force, group, forces, sums);
  }
}

void add_further(const TissueBatches& tissue, const FurtherFibres& batch, const double* nodes, const FibreDrive* drives,
                 Forces& forces, LaneSums& sums) {
  for (int group = 0; group < kTetLanes; group += kGroup) {
    Number force[3][3];
    for (auto& corner : force) {
      for (Number& axis : corner) axis = number(0);
    }
    pull_fibres(tissue, batch.fibres, group, corners_of(batch.node, group, nodes), drives, force, sums);
    keep(force, group, forces, sums);
  }
}

TissueSum add_all(const TissueBatches& tissue, const double* nodes, const FibreDrive* drives, double steepest,
                  double least_volume, double* gradient) {
  LaneSums sums;
  Forces forces;
  for (std::size_t b = 0; b < tissue.tets.size(); ++b) {
    add_batch(tissue, b, nodes, drives, steepest, least_volume, forces, sums);
    scatter(tissue.tets[b].node, forces, gradient);
  }
  for (const FurtherFibres& batch : tissue.further) {
    add_further(tissue, batch, nodes, drives, forces, sums);
    scatter(batch.node, forces, gradient);
  }
  TissueSum sum;
  for (int lane = 0; lane < kTetLanes; ++lane) {
    sum.energy += sums.energy[lane];
    sum.force_square += sums.force_square[lane];
  }
  return sum;
}

void find_ratios(const TetBatch& batch, const double* nodes, double* ratios) {
  for (int group = 0; group < kTetLanes; group += kGroup) {
    store(strain_of(batch, group, corners_of(batch.node, group, nodes)).volume_ratio, ratios + group);
  }
}

}  // namespace bodyopt::trainer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace bodyopt::trainer {

HWY_EXPORT(add_all);
HWY_EXPORT(find_ratios);

TissueSum add_tissue_forces(const TissueBatches& tissue, const double* nodes, std::span<const FibreDrive> drives,
                            double steepest, double least_volume, double* gradient) {
  return HWY_DYNAMIC_DISPATCH(add_all)(tissue, nodes, drives.data(), steepest, least_volume, gradient);
}

void find_volume_ratios(const TetBatch& batch, const double* nodes, double (&ratios)[kTetLanes]) {
  HWY_DYNAMIC_DISPATCH(find_ratios)(batch, nodes, ratios);
}

}  // namespace bodyopt::trainer
#endif
