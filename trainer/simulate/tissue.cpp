#include "trainer/simulate/tissue.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace bodyopt {
namespace {

// Value and slope of (J - b)^2 (-ln(J / b)), b = kBarrierVolume, extended.
struct Barrier {
  double value, slope;
};
Barrier barrier(double j, double steepest) {
  const double from = std::max(j, steepest), below = from - Tissue::kBarrierVolume;
  const double log_ratio = std::log(from / Tissue::kBarrierVolume);
  const double slope = -2 * below * log_ratio - below * below / from;
  return {-below * below * log_ratio + (j - from) * slope, slope};
}

// Those whose tet an earlier one has; they are sorted by tet.
std::vector<FibreTet> take_repeated(std::vector<FibreTet>& fibres) {
  std::vector<FibreTet> first, repeated;
  for (const FibreTet& fibre : fibres) {
    (first.empty() || first.back().tet != fibre.tet ? first : repeated).push_back(fibre);
  }
  fibres = std::move(first);
  return repeated;
}

}  // namespace

// Edge vectors from corner 0 to corners 1..3: edge[corner][axis][lane], metres.
struct Tissue::Corners {
  double edge[3][3][kLanes];
};

struct Tissue::Strain {
  double f[3][3][kLanes];         // deformation gradient
  double cofactor[3][3][kLanes];  // dJ/dF
  double volume_ratio[kLanes];    // J
  double square[kLanes];          // |F|^2
};

Tissue::Tissue(const TetMesh& mesh, const std::vector<TetMaterial>& tets, std::vector<FibreTet> fibres,
               const Materials& materials)
    : active_(materials.active_fibre), passive_(materials.passive_fibre) {
  const int count = static_cast<int>(mesh.tets.rows());
  for (int t = 0; t < count; ++t) mean_volume_ += tet_edges(mesh, t).determinant() / 6 / count;
  std::stable_sort(fibres.begin(), fibres.end(), [](const FibreTet& a, const FibreTet& b) { return a.tet < b.tet; });
  add_further(mesh, take_repeated(fibres));
  std::vector<int> order;
  std::vector<bool> is_muscle(static_cast<std::size_t>(count), false);
  for (const FibreTet& fibre : fibres) {
    order.push_back(fibre.tet);
    is_muscle[static_cast<std::size_t>(fibre.tet)] = true;
  }
  for (int t = 0; t < count; ++t) {
    if (!is_muscle[static_cast<std::size_t>(t)]) order.push_back(t);
  }
  batches_.resize((order.size() + kLanes - 1) / kLanes);
  fibres_.resize((fibres.size() + kLanes - 1) / kLanes);
  for (std::size_t k = 0; k < batches_.size() * kLanes; ++k) {
    Batch& batch = batches_[k / kLanes];
    const std::size_t lane = k % kLanes;
    const bool empty = k >= order.size();
    const int t = order[std::min(k, order.size() - 1)];
    const TetMaterial& material = tets[static_cast<std::size_t>(t)];
    for (int a = 0; a < 4; ++a) batch.node[a][lane] = mesh.tets(t, a);
    const Eigen::Matrix3d edges = tet_edges(mesh, t);
    const Eigen::Matrix3d slopes = edges.inverse();
    for (int a = 0; a < 3; ++a) {
      for (int i = 0; i < 3; ++i) batch.slope[a][i][lane] = slopes(a, i);
    }
    batch.volume[lane] = empty ? 0 : edges.determinant() / 6;
    batch.mu[lane] = material.mu;
    batch.lambda[lane] = material.lambda;
    if (k / kLanes >= fibres_.size()) continue;
    FibreBatch& fibre = fibres_[k / kLanes];
    const bool passive = k >= fibres.size();
    const FibreTet& of_muscle = fibres[std::min(k, fibres.size() - 1)];
    const Eigen::Vector3d along = slopes * of_muscle.direction;
    for (int a = 0; a < 3; ++a) fibre.slope[a][lane] = along[a];
    fibre.volume[lane] = passive ? 0 : of_muscle.share * batch.volume[lane];
    fibre.muscle[lane] = of_muscle.muscle;
  }
}

void Tissue::add_further(const TetMesh& mesh, const std::vector<FibreTet>& fibres) {
  further_.resize((fibres.size() + kLanes - 1) / kLanes);
  for (std::size_t k = 0; k < further_.size() * kLanes; ++k) {
    FurtherFibres& batch = further_[k / kLanes];
    const std::size_t lane = k % kLanes;
    const FibreTet& fibre = fibres[std::min(k, fibres.size() - 1)];
    const Eigen::Matrix3d edges = tet_edges(mesh, fibre.tet);
    const Eigen::Vector3d along = edges.inverse() * fibre.direction;
    for (int a = 0; a < 4; ++a) batch.node[a][lane] = mesh.tets(fibre.tet, a);
    for (int a = 0; a < 3; ++a) batch.fibres.slope[a][lane] = along[a];
    batch.fibres.volume[lane] = k < fibres.size() ? fibre.share * edges.determinant() / 6 : 0;
    batch.fibres.muscle[lane] = fibre.muscle;
  }
}

void Tissue::gather(const int (&node)[4][kLanes], const Positions& nodes, Corners& corners) const {
  const double* x = nodes.data();
  for (int lane = 0; lane < kLanes; ++lane) {
    const double* origin = x + 3 * static_cast<std::ptrdiff_t>(node[0][lane]);
    for (int a = 0; a < 3; ++a) {
      const double* corner = x + 3 * static_cast<std::ptrdiff_t>(node[a + 1][lane]);
      for (int i = 0; i < 3; ++i) corners.edge[a][i][lane] = corner[i] - origin[i];
    }
  }
}

// Returns the smallest J.
double Tissue::strain(const Batch& batch, const Corners& corners, Strain& strain) const {
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      for (int lane = 0; lane < kLanes; ++lane) {
        strain.f[i][k][lane] = corners.edge[0][i][lane] * batch.slope[0][k][lane] +
                               corners.edge[1][i][lane] * batch.slope[1][k][lane] +
                               corners.edge[2][i][lane] * batch.slope[2][k][lane];
      }
    }
  }
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int k = 0; k < 3; ++k) {
      const int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
      for (int lane = 0; lane < kLanes; ++lane) {
        strain.cofactor[i][k][lane] =
            strain.f[i1][k1][lane] * strain.f[i2][k2][lane] - strain.f[i1][k2][lane] * strain.f[i2][k1][lane];
      }
    }
  }
  double smallest = std::numeric_limits<double>::infinity();
  for (int lane = 0; lane < kLanes; ++lane) {
    double j = 0, square = 0;
    for (int k = 0; k < 3; ++k) j += strain.f[0][k][lane] * strain.cofactor[0][k][lane];
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) square += strain.f[i][k][lane] * strain.f[i][k][lane];
    }
    strain.volume_ratio[lane] = j;
    strain.square[lane] = square;
    smallest = j < smallest ? j : smallest;
  }
  return smallest;
}

// Adds to force[corner][axis][lane]; returns the energy.
double Tissue::fibre_force(const FibreBatch& batch, const Corners& corners, std::span<const FibreDrive> drives,
                           double (&force)[3][3][kLanes]) const {
  double energy = 0;
  for (int lane = 0; lane < kLanes; ++lane) {
    double v[3];
    for (int i = 0; i < 3; ++i) {
      v[i] = corners.edge[0][i][lane] * batch.slope[0][lane] + corners.edge[1][i][lane] * batch.slope[1][lane] +
             corners.edge[2][i][lane] * batch.slope[2][lane];
    }
    const double stretch = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    const FibreDrive& drive = drives[static_cast<std::size_t>(batch.muscle[lane])];
    const double active = std::max(stretch - drive.slack, 0.0), passive = std::max(stretch - 1, 0.0);
    const double stiffness = drive.activation * active_;
    energy += batch.volume[lane] * 0.5 * (stiffness * active * active + passive_ * passive * passive);
    const double pull = batch.volume[lane] * (stiffness * active + passive_ * passive) / std::max(stretch, 1e-12);
    for (int a = 0; a < 3; ++a) {
      for (int i = 0; i < 3; ++i) force[a][i][lane] += pull * batch.slope[a][lane] * v[i];
    }
  }
  return energy;
}

// Adds to the gradient what corners 1..3 are pulled with, and its opposite to corner 0.
void Tissue::scatter(const int (&node)[4][kLanes], const double (&force)[3][3][kLanes], Positions& gradient,
                     Sum& sum) const {
  double* out = gradient.data();
  for (int lane = 0; lane < kLanes; ++lane) {
    double* origin = out + 3 * static_cast<std::ptrdiff_t>(node[0][lane]);
    double total[3] = {0, 0, 0};
    for (int a = 0; a < 3; ++a) {
      double* corner = out + 3 * static_cast<std::ptrdiff_t>(node[a + 1][lane]);
      for (int i = 0; i < 3; ++i) {
        const double f = force[a][i][lane];
        corner[i] += f;
        total[i] += f;
        sum.force_square += f * f;
      }
    }
    for (int i = 0; i < 3; ++i) {
      origin[i] -= total[i];
      sum.force_square += total[i] * total[i];
    }
  }
}

Tissue::Sum Tissue::add_gradient(const Positions& nodes, std::span<const FibreDrive> drives, Positions& gradient,
                                 const BarrierShape& shape) const {
  Sum sum;
  for (std::size_t b = 0; b < batches_.size(); ++b) {
    const Batch& batch = batches_[b];
    Corners corners;
    Strain s;
    gather(batch.node, nodes, corners);
    const double smallest = strain(batch, corners, s);
    double pressure[kLanes], density[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) {
      const double rest = batch.mu[lane] / batch.lambda[lane], j = s.volume_ratio[lane] - 1 - rest;
      pressure[lane] = batch.lambda[lane] * j;
      density[lane] = 0.5 * (batch.mu[lane] * (s.square[lane] - 3) + batch.lambda[lane] * (j * j - rest * rest));
    }
    if (smallest < kBarrierVolume) {
      for (int lane = 0; lane < kLanes; ++lane) {
        if (s.volume_ratio[lane] >= kBarrierVolume) continue;
        const Barrier push = barrier(s.volume_ratio[lane], shape.steepest);
        const double least = shape.least_volume * mean_volume_, volume = batch.volume[lane];
        const bool is_tiny = volume > 0 && volume < least;  // 0: an empty lane
        const double kappa = kBarrierWeight * batch.lambda[lane] * (is_tiny ? least / volume : 1);
        density[lane] += kappa * push.value;
        pressure[lane] += kappa * push.slope;
      }
    }
    double stress[3][3][kLanes], force[3][3][kLanes];
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        for (int lane = 0; lane < kLanes; ++lane) {
          stress[i][k][lane] =
              batch.volume[lane] * (batch.mu[lane] * s.f[i][k][lane] + pressure[lane] * s.cofactor[i][k][lane]);
        }
      }
    }
    for (int a = 0; a < 3; ++a) {
      for (int i = 0; i < 3; ++i) {
        for (int lane = 0; lane < kLanes; ++lane) {
          force[a][i][lane] = stress[i][0][lane] * batch.slope[a][0][lane] +
                              stress[i][1][lane] * batch.slope[a][1][lane] +
                              stress[i][2][lane] * batch.slope[a][2][lane];
        }
      }
    }
    for (int lane = 0; lane < kLanes; ++lane) sum.energy += batch.volume[lane] * density[lane];
    if (b < fibres_.size()) sum.energy += fibre_force(fibres_[b], corners, drives, force);
    scatter(batch.node, force, gradient, sum);
  }
  for (const FurtherFibres& batch : further_) {
    Corners corners;
    gather(batch.node, nodes, corners);
    double force[3][3][kLanes] = {};
    sum.energy += fibre_force(batch.fibres, corners, drives, force);
    scatter(batch.node, force, gradient, sum);
  }
  return sum;
}

Tissue::Inverted Tissue::inverted(const Positions& nodes) const {
  Inverted result;
  double volume = 0;
  for (const Batch& batch : batches_) {
    Corners corners;
    Strain s;
    gather(batch.node, nodes, corners);
    strain(batch, corners, s);
    for (int lane = 0; lane < kLanes; ++lane) {
      volume += batch.volume[lane];
      if (!(batch.volume[lane] > 0) || s.volume_ratio[lane] > 0) continue;
      ++result.tets;
      result.share += batch.volume[lane];
    }
  }
  if (volume > 0) result.share /= volume;
  return result;
}

}  // namespace bodyopt
