// Those samples of a half body that muscles can have: neither bone, fat nor cavity.
#pragma once

#include <array>
#include <vector>

#include "trainer/anatomy/inner_tissue.h"

namespace bodyopt {

struct LeanSamples {
  const BodyGrid& grid;
  const InnerTissue& tissue;
  std::vector<int> sample;                     // L: in the grid
  std::vector<int> lean;                       // S: in `sample`, -1: other tissue
  Positions points;                            // L x 3
  std::vector<std::array<int, 6>> neighbours;  // L: lean samples that share a face, along -x, +x, -y ...; -1: none

  LeanSamples(const BodyGrid& grid, const InnerTissue& tissue);
  std::size_t size() const { return sample.size(); }
  BodyRegion region(std::size_t lean_sample) const {
    return tissue.region[static_cast<std::size_t>(sample[lean_sample])];
  }
};

}  // namespace bodyopt
