#include "trainer/train/judge/unposing_residual.h"

#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "trainer/train/data/unposed_shapes.h"
#include "trainer/train/skinning/mesh_table.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt {

UnposingResidual unposing_residual(const SampleSet& set, const Basis& basis) {
  const std::vector<std::uint32_t> order = morton_order(set.character.vertices);
  const Character ordered = in_order(set.character, order);
  const std::vector<std::size_t> frames = spread_evenly(set.train.size(), 200);
  std::vector<double> lbs(frames.size()), ddm(frames.size());
  parallel_for(frames.size(), [&](std::size_t n) {
    const Sample& sample = set.train[frames[n]];
    const Positions shape = in_order(sample.shape.read(), order);
    lbs[n] = unpose_linear(ordered, sample.pose, shape).squaredNorm();
    ddm[n] = unpose_ddm(basis, sample.pose, shape).squaredNorm();
  });
  const auto rms_mm = [&](const std::vector<double>& sums) {
    const double count = static_cast<double>(frames.size()) * static_cast<double>(ordered.vertices.rows());
    return count > 0 ? 1e3 * std::sqrt(std::accumulate(sums.begin(), sums.end(), 0.0) / count) : 0;
  };
  return {rms_mm(lbs), rms_mm(ddm)};
}

}  // namespace bodyopt
