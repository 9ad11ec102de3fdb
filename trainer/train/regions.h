// Soft regions of the skin: a partition of unity.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "runtime/basis/basis.h"
#include "trainer/dataset/character.h"

namespace bodyopt {

// One region: the vertices with weight, ascending. Over all regions the weights of a vertex sum to 1.
struct SoftRegion {
  std::vector<std::uint32_t> vertices;
  std::vector<float> weights;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // weighted mean rest position, metres
};

// Regions of about half a limb: seeds far apart in position and skin weights, blended and smoothed over the skin.
// `character` in any vertex order; the regions use the same.
std::vector<SoftRegion> soft_regions(const Character& character);

// Real lengths in metres are meant for a human body; this scales them for giants and dwarfs.
double body_scale(const Positions& rest);

}  // namespace bodyopt
