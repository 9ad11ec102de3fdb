#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tets.h"

namespace bodyopt::testing {
namespace diffuse_surface_test {

constexpr std::uint32_t kVertices = 200, kInside = 5;

struct Case {
  Case(std::uint32_t surface_count, std::uint32_t frame_count)
      : random(surface_count + 31 * frame_count),
        frames(frame_count),
        positions(random.floats(std::size_t{3} * kVertices * frames, -1, 1)),
        origins(random.floats(std::size_t{4} * frames, -100, 100)),
        before(random.floats(std::size_t{3} * (surface_count + kInside) * frames, -1, 1)),
        nodes(before) {
    tets.nodes.resize(std::size_t{3} * (surface_count + kInside));
    tets.surface = random_surface_points(random, kVertices, surface_count);
    for (std::size_t k = 0; k < positions.size(); ++k) positions[k] += origins[4 * (k / (3 * kVertices)) + k % 3];
    cpu::diffuse_surface(tets, positions, origins, frames, nodes);
  }

  Random random;
  std::uint32_t frames;
  TetTable tets;
  std::vector<float> positions, origins, before;
  std::vector<float> nodes;  // by the reference
};

const bool added = add_kernel_cases_of_frames("diffuse_surface", "nodes", [](KernelSet& kernels, const Trial& trial) {
  const Case c(trial.size, trial.variant);
  // Sums and products in one order; nodes inside are left.
  return run_on<vulkan::DiffuseSurface>(kernels, {trial.size, kVertices, trial.size + kInside}, c.frames,
                                        {{.values = c.nodes, .before = c.before}}, c.tets.surface, c.positions,
                                        c.origins);
});

// A skin that is an affine image of itself carries its points by the same map.
TEST(DiffuseSurfaceReference, CarriesAnAffineMap) {
  Case c(300, 2);
  const std::vector<float> rest = c.random.floats(std::size_t{3} * kVertices, -1, 1);
  Eigen::Matrix3d map[2];
  Eigen::Vector3d offset[2];
  c.positions.clear();
  for (std::size_t f = 0; f < 2; ++f) {
    for (int i = 0; i < 9; ++i) map[f](i / 3, i % 3) = c.random.uniform(-1, 1);
    for (int i = 0; i < 3; ++i) offset[f][i] = c.random.uniform(-1, 1);
    for (std::size_t v = 0; v < kVertices; ++v) {
      append_point(c.positions, map[f] * point_of(rest, v) + offset[f] +
                                    Eigen::Map<const Eigen::Vector3f>(c.origins.data() + 4 * f).cast<double>());
    }
  }
  std::vector<float> nodes = c.before;
  cpu::diffuse_surface(c.tets, c.positions, c.origins, 2, nodes);
  for (std::size_t k = 0; k < nodes.size() / 3; ++k) {
    const std::size_t node = k % (300 + kInside), f = k / (300 + kInside);
    if (node >= 300) {
      EXPECT_EQ(point_of(nodes, k), point_of(c.before, k));
      continue;
    }
    const SurfacePoint& p = c.tets.surface[node];
    const Eigen::Vector3d at = static_cast<double>(p.wa) * point_of(rest, p.a) +
                               static_cast<double>(p.wb) * point_of(rest, p.b) +
                               static_cast<double>(p.wc) * point_of(rest, p.c);
    // 8e-6 m: the rounding of positions 100 m away, and no more of it for weights that do not quite sum to 1.
    ASSERT_LT((point_of(nodes, k) - map[f] * at - offset[f]).cwiseAbs().maxCoeff(), 8e-6);
  }
}

}  // namespace diffuse_surface_test
}  // namespace bodyopt::testing
