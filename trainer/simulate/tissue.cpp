#include "trainer/simulate/tissue.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

namespace bodyopt::trainer {
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

// Takes out the fibres whose tet an earlier one has; they are sorted by tet.
std::vector<FibreTet> take_repeated(std::vector<FibreTet>& fibres) {
  std::vector<FibreTet> first, repeated;
  for (const FibreTet& fibre : fibres) {
    (first.empty() || first.back().tet != fibre.tet ? first : repeated).push_back(fibre);
  }
  fibres = std::move(first);
  return repeated;
}

}  // namespace

Tissue::Tissue(const TetMesh& mesh, const std::vector<TetMaterial>& tets, std::vector<FibreTet> fibres,
               const Materials& materials)
    : batches_{{}, {}, {}, materials.active_fibre, materials.passive_fibre} {
  if (!mesh.is_second_order) {
    add_batches(mesh, tets, std::move(fibres));
    return;
  }
  points_ = QuadraturePoints(mesh);
  add_batches(points_.tets(mesh), QuadraturePoints::of_points(tets), QuadraturePoints::of_points(fibres));
}

void Tissue::add_batches(const TetMesh& mesh, const std::vector<TetMaterial>& tets, std::vector<FibreTet> fibres) {
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
  std::vector<TetBatch>& batches = batches_.tets;
  batches.resize((order.size() + kTetLanes - 1) / kTetLanes);
  batches_.fibres.resize((fibres.size() + kTetLanes - 1) / kTetLanes);
  for (std::size_t k = 0; k < batches.size() * kTetLanes; ++k) {
    TetBatch& batch = batches[k / kTetLanes];
    const std::size_t lane = k % kTetLanes;
    const bool empty = k >= order.size();
    const int t = order[std::min(k, order.size() - 1)];
    const TetMaterial& material = tets[static_cast<std::size_t>(t)];
    for (int a = 0; a < 4; ++a) batch.node[a][lane] = 3 * mesh.tets(t, a);
    const Eigen::Matrix3d edges = tet_edges(mesh, t);
    const Eigen::Matrix3d slopes = edges.inverse();
    for (int a = 0; a < 3; ++a) {
      for (int i = 0; i < 3; ++i) batch.slope[a][i][lane] = slopes(a, i);
    }
    batch.volume[lane] = empty ? 0 : edges.determinant() / 6;
    batch.mu[lane] = material.mu;
    batch.lambda[lane] = material.lambda;
    if (k / kTetLanes >= batches_.fibres.size()) continue;
    FibreBatch& fibre = batches_.fibres[k / kTetLanes];
    const bool passive = k >= fibres.size();
    const FibreTet& of_muscle = fibres[std::min(k, fibres.size() - 1)];
    const Eigen::Vector3d along = slopes * of_muscle.direction;
    for (int a = 0; a < 3; ++a) fibre.slope[a][lane] = along[a];
    fibre.volume[lane] = passive ? 0 : of_muscle.share * batch.volume[lane];
    fibre.muscle[lane] = of_muscle.muscle;
  }
}

void Tissue::add_further(const TetMesh& mesh, const std::vector<FibreTet>& fibres) {
  batches_.further.resize((fibres.size() + kTetLanes - 1) / kTetLanes);
  for (std::size_t k = 0; k < batches_.further.size() * kTetLanes; ++k) {
    FurtherFibres& batch = batches_.further[k / kTetLanes];
    const std::size_t lane = k % kTetLanes;
    const FibreTet& fibre = fibres[std::min(k, fibres.size() - 1)];
    const Eigen::Matrix3d edges = tet_edges(mesh, fibre.tet);
    const Eigen::Vector3d along = edges.inverse() * fibre.direction;
    for (int a = 0; a < 4; ++a) batch.node[a][lane] = 3 * mesh.tets(fibre.tet, a);
    for (int a = 0; a < 3; ++a) batch.fibres.slope[a][lane] = along[a];
    batch.fibres.volume[lane] = k < fibres.size() ? fibre.share * edges.determinant() / 6 : 0;
    batch.fibres.muscle[lane] = fibre.muscle;
  }
}

void add_barrier(const TetBatch& batch, double steepest, double least_volume, BatchStress& stress) {
  for (int lane = 0; lane < kTetLanes; ++lane) {
    if (stress.volume_ratio[lane] >= Tissue::kBarrierVolume) continue;
    const Barrier push = barrier(stress.volume_ratio[lane], steepest);
    const double volume = batch.volume[lane];
    const bool is_tiny = volume > 0 && volume < least_volume;  // 0: an empty lane
    const double kappa = Tissue::kBarrierWeight * batch.lambda[lane] * (is_tiny ? least_volume / volume : 1);
    stress.density[lane] += kappa * push.value;
    stress.pressure[lane] += kappa * push.slope;
  }
}

TissueSum Tissue::add_gradient(const Positions& nodes, std::span<const FibreDrive> drives, Positions& gradient,
                               const BarrierShape& shape) const {
  const auto add = [&](const Positions& at, Positions& to) {
    return add_tissue_forces(batches_, at.data(), drives, shape.steepest, shape.least_volume * mean_volume_, to.data());
  };
  if (points_.empty()) return add(nodes, gradient);
  const Positions corners = points_.corners(nodes);
  Positions of_corners = Positions::Zero(corners.rows(), 3);
  const TissueSum sum = add(corners, of_corners);
  points_.add_gradient(of_corners, gradient);
  return sum;
}

Tissue::Inverted Tissue::inverted(const Positions& nodes) const {
  const Positions corners = points_.empty() ? Positions() : points_.corners(nodes);
  Inverted result;
  double volume = 0;
  for (const TetBatch& batch : batches_.tets) {
    double ratios[kTetLanes];
    find_volume_ratios(batch, points_.empty() ? nodes.data() : corners.data(), ratios);
    for (int lane = 0; lane < kTetLanes; ++lane) {
      volume += batch.volume[lane];
      if (!(batch.volume[lane] > 0) || ratios[lane] > 0) continue;
      ++result.tets;
      result.share += batch.volume[lane];
    }
  }
  if (volume > 0) result.share /= volume;
  return result;
}

}  // namespace bodyopt::trainer
