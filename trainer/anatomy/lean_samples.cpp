#include "trainer/anatomy/lean_samples.h"

namespace bodyopt {

LeanSamples::LeanSamples(const BodyGrid& own_grid, const InnerTissue& own_tissue)
    : grid(own_grid), tissue(own_tissue), lean(static_cast<std::size_t>(own_grid.size()), -1) {
  for (int s = 0; s < grid.size(); ++s) {
    if (tissue.kind(s) != TissueKind::other_lean) continue;
    lean[static_cast<std::size_t>(s)] = static_cast<int>(sample.size());
    sample.push_back(s);
  }
  points = grid.points(sample, Eigen::all);
  for (const int s : sample) {
    neighbours.push_back(grid.beside(s));
    for (int& other : neighbours.back()) other = other < 0 ? -1 : lean[static_cast<std::size_t>(other)];
  }
}

}  // namespace bodyopt
