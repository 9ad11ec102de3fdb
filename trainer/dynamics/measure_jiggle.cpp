#include "trainer/dynamics/measure_jiggle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "runtime/basis/dynamics.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/host/jiggle.h"

namespace bodyopt {
namespace {

constexpr double kAtLimit = 0.75;  // of the limit: what is shown of a displacement as large as the limit

std::uint32_t count_inverted(const TetTable& tets, const std::vector<float>& nodes) {
  const auto node = [&](std::uint32_t n) {
    return Eigen::Map<const Eigen::Vector3f>(nodes.data() + std::size_t{3} * n).cast<double>().eval();
  };
  std::uint32_t inverted = 0;
  for (std::size_t t = 0; t < tets.tets.size(); t += 4) {
    const Eigen::Vector3d origin = node(tets.tets[t]);
    const Eigen::Vector3d a = node(tets.tets[t + 1]) - origin, b = node(tets.tets[t + 2]) - origin,
                          c = node(tets.tets[t + 3]) - origin;
    inverted += a.cross(b).dot(c) > 0 ? 0 : 1;
  }
  return inverted;
}

}  // namespace

JiggleMeasure measure_jiggle(const Dynamics& dynamics, const NodeMotion& motion) {
  const TetTable& tets = dynamics.tets;
  JiggleMeasure measure{.inverted_tets = count_inverted(tets, motion.nodes)};
  // What the skin is given is the same wherever it is.
  const std::vector<float> nowhere(3 * tets.skin.size(), 0.0f);
  std::vector<float> moved(nowhere.size());
  cpu::jiggle_skin(tets, nowhere, motion.displacement, 1, moved);
  double sum = 0, largest = 0, largest_share = 0;
  for (std::size_t v = 0; v < tets.skin.size(); ++v) {
    const double squared = Eigen::Map<const Eigen::Vector3f>(moved.data() + 3 * v).cast<double>().squaredNorm();
    sum += squared;
    largest = std::max(largest, squared);
    const double share = std::sqrt(squared) / static_cast<double>(tets.skin_limit[v] * tets.skin[v].amount);
    if (!(share > kAtLimit)) continue;
    ++measure.limited;
    if (share > largest_share) measure.most_limited = static_cast<std::uint32_t>(v);
    largest_share = std::max(largest_share, share);
  }
  measure.rms_mm = 1e3 * std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, tets.skin.size())));
  measure.max_mm = 1e3 * std::sqrt(largest);
  return measure;
}

}  // namespace bodyopt
