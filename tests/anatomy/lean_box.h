// A block of lean tissue between two bones: what muscles divide, without a body around it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "trainer/anatomy/inner_tissue.h"

namespace bodyopt {

// Joint 0 moves the bone below (y of the first two layers of cells), joint 1 the one above; x and z are about 0.
struct LeanBox {
  trainer::HalfBody body;
  trainer::BodyGrid grid;
  trainer::InnerTissue tissue;

  // `is_bone`: of places that are neither, joint 0's, too. Only places that are `inside` have samples.
  LeanBox(const Eigen::Vector3i& count, double cell, const std::function<bool(const Eigen::Vector3d&)>& is_bone = {},
          const std::function<bool(const Eigen::Vector3d&)>& inside = {}) {
    grid.cell = cell;
    grid.count = count;
    grid.low = {-0.5 * cell * count.x(), 0, -0.5 * cell * count.z()};
    grid.sample.assign(static_cast<std::size_t>(count.prod()), -1);
    auto next = grid.sample.begin();
    std::vector<Eigen::Vector3d> points;
    for (int x = 0; x < count.x(); ++x) {
      for (int y = 0; y < count.y(); ++y) {
        for (int z = 0; z < count.z(); ++z, ++next) {
          const Eigen::Vector3i at(x, y, z);
          const Eigen::Vector3d point = grid.low + cell * (at.cast<double>().array() + 0.5).matrix();
          if (inside && !inside(point)) continue;
          *next = grid.size();
          grid.cells.push_back(at);
          points.push_back(point);
        }
      }
    }
    const auto rows = static_cast<Eigen::Index>(points.size());
    grid.points.resize(rows, 3);
    tissue.bone.resize(rows);
    tissue.bone_joint.assign(points.size(), 0);
    tissue.fat = tissue.cavity = Eigen::VectorXd::Constant(rows, 1);
    tissue.region.assign(points.size(), trainer::BodyRegion::thigh);
    for (Eigen::Index s = 0; s < rows; ++s) {
      const auto at = static_cast<std::size_t>(s);
      grid.points.row(s) = points[at].transpose();
      const int layer = grid.cells[at].y();
      const bool is_end = layer < 2 || layer >= count.y() - 2;
      tissue.bone_joint[at] = layer >= count.y() - 2 ? 1 : 0;
      tissue.bone[s] = (is_end || (is_bone && is_bone(points[at])) ? -0.5 : 0.5) * cell;
    }
    body.has_plane = body.is_own_mirror = false;
    body.joints = {{"below", -1}, {"above", 0}};
    body.roles.resize(2);
    body.places = {{0, 0, 0}, {0, height(), 0}};
    body.vertices.resize(2, 3);
    body.vertices << 0, 0, 0, 0, 1.75, 0;
    body.weights.resize(2);
  }

  double height() const { return grid.cell * grid.count.y(); }

  // From bone to bone at a place of the section, with the radius that tells a volume (2 r^2 l).
  Muscle upright(const std::string& name, double x, double z, double volume) const {
    Muscle muscle;
    muscle.name = name;
    muscle.path = {{0, {x, 1.5 * grid.cell, z}}, {1, {x, height() - 1.5 * grid.cell, z}}};
    muscle.radius = std::sqrt(volume / (2 * (height() - 3 * grid.cell)));
    return muscle;
  }
};

}  // namespace bodyopt
