#include "trainer/simulate/muscle_volume.h"

#include <Eigen/Geometry>
#include <cmath>
#include <map>

#include "trainer/simulate/materials.h"

namespace bodyopt::trainer {

MuscleVolume::MuscleVolume(const TetMesh& mesh, const std::vector<FibreTet>& fibres, std::size_t muscle_count,
                           const Materials& materials)
    : rest_(muscle_count, 0.0), bulk_(materials.muscle_bulk) {
  for (const FibreTet& fibre : fibres) {
    Part part{{}, fibre.muscle, fibre.share};
    for (int a = 0; a < 4; ++a) part.node[a] = mesh.tets(fibre.tet, a);
    parts_.push_back(part);
  }
  rest_ = volumes(mesh.nodes);
}

// The gradient of the tet's volume, times the share that counts, for each corner.
Eigen::Matrix<double, 4, 3> MuscleVolume::volume_slope(const Part& part, const Positions& nodes) {
  const Eigen::RowVector3d origin = nodes.row(part.node[0]);
  const Eigen::RowVector3d a = nodes.row(part.node[1]) - origin, b = nodes.row(part.node[2]) - origin,
                           c = nodes.row(part.node[3]) - origin;
  Eigen::Matrix<double, 4, 3> slope;
  slope.row(1) = part.share / 6 * b.cross(c);
  slope.row(2) = part.share / 6 * c.cross(a);
  slope.row(3) = part.share / 6 * a.cross(b);
  slope.row(0) = -slope.bottomRows<3>().colwise().sum();
  return slope;
}

std::vector<double> MuscleVolume::volumes(const Positions& nodes) const {
  std::vector<double> volumes(rest_.size(), 0.0);
  for (const Part& part : parts_) {
    const Eigen::RowVector3d origin = nodes.row(part.node[0]);
    const Eigen::RowVector3d a = nodes.row(part.node[1]) - origin, b = nodes.row(part.node[2]) - origin,
                             c = nodes.row(part.node[3]) - origin;
    volumes[static_cast<std::size_t>(part.muscle)] += part.share * a.cross(b).dot(c) / 6;
  }
  return volumes;
}

double MuscleVolume::add_gradient(const Positions& nodes, Positions& gradient) const {
  const std::vector<double> now = volumes(nodes);
  std::vector<double> pressure(rest_.size(), 0.0);
  double energy = 0;
  for (std::size_t m = 0; m < rest_.size(); ++m) {
    if (!(rest_[m] > 0)) continue;
    const double change = now[m] / rest_[m] - 1;
    pressure[m] = bulk_ * change;
    energy += 0.5 * bulk_ * rest_[m] * change * change;
  }
  for (const Part& part : parts_) {
    const Eigen::Matrix<double, 4, 3> slope =
        pressure[static_cast<std::size_t>(part.muscle)] * volume_slope(part, nodes);
    for (int a = 0; a < 4; ++a) gradient.row(part.node[a]) += slope.row(a);
  }
  return energy;
}

std::pair<std::vector<SparseMode>, std::vector<double>> MuscleVolume::stiff_modes(const Positions& nodes) const {
  std::vector<std::map<int, Eigen::RowVector3d>> slopes(rest_.size());
  for (const Part& part : parts_) {
    const Eigen::Matrix<double, 4, 3> slope = volume_slope(part, nodes);
    auto& of_muscle = slopes[static_cast<std::size_t>(part.muscle)];
    for (int a = 0; a < 4; ++a) {
      of_muscle.try_emplace(part.node[a], Eigen::RowVector3d::Zero()).first->second += slope.row(a);
    }
  }
  std::pair<std::vector<SparseMode>, std::vector<double>> result;
  for (std::size_t m = 0; m < rest_.size(); ++m) {
    if (!(rest_[m] > 0)) continue;
    result.first.emplace_back(slopes[m].begin(), slopes[m].end());
    result.second.push_back(bulk_ / rest_[m]);
  }
  return result;
}

double MuscleVolume::largest_change(const Positions& nodes) const {
  const std::vector<double> now = volumes(nodes);
  double largest = 0;
  for (std::size_t m = 0; m < rest_.size(); ++m) {
    if (!(rest_[m] > 0)) continue;
    const double change = now[m] / rest_[m] - 1;
    if (std::abs(change) > std::abs(largest)) largest = change;
  }
  return largest;
}

}  // namespace bodyopt::trainer
