// A regular grid of samples inside one half of a body.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "geometry/nearest_skin.h"
#include "trainer/anatomy/half_body.h"

namespace bodyopt::trainer {

// Space of the half body. The median plane lies between cells.
struct BodyGrid {
  double cell = 0;                     // metres, the edge of a cell
  Eigen::Vector3d low;                 // lowest corner of cell (0, 0, 0)
  Eigen::Vector3i count;               // cells along x, y, z
  std::vector<int> sample;             // count x * y * z, z fastest: the sample at the middle of a cell, -1 outside
  std::vector<Eigen::Vector3i> cells;  // S
  Positions points;                    // S x 3
  Eigen::VectorXd depth;               // S: exact distance to the skin
  std::vector<SkinPoint> skin;         // S: the point of the skin nearest to the sample
  std::vector<std::string> notes;      // what is wrong with the skin, one sentence each

  int size() const { return static_cast<int>(cells.size()); }
  int sample_at(const Eigen::Vector3i& at) const;  // -1 outside
  int sample_at(const Eigen::Vector3d& point) const;
  std::array<int, 6> beside(int sample) const;  // samples that share a face, along -x, +x, -y ...; -1: outside
  double volume() const { return cell * cell * cell; }
  // A value per vertex of the skin, at the skin point nearest to a sample.
  double on_skin(const Eigen::VectorXd& values, int sample) const;
};

// Samples the cells whose middles are inside: the crossings of the skin along z sum to more than none. Small
// self-intersections do not matter then. Beside holes, where those of a line do not end at none, lines along x, then y
// decide. Throws Error(mismatch) where the skin encloses nothing.
BodyGrid sample_body(const HalfBody& body, double cell);

// The edge of cells, 5 mm in a body of 60 l (1.75 m). It grows with the cube root of the volume that the skin encloses.
double default_cell(const Character& character);

}  // namespace bodyopt::trainer
