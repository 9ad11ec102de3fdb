#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_jiggle.h"
#include "tests/support/textbook_ddm.h"

namespace bodyopt::testing {
namespace jiggle_tet_rotate_test {

constexpr std::uint32_t kBatch = 3;

// Nodes anywhere, another place each frame.
struct Case {
  explicit Case(std::uint32_t count)
      : random(count),
        frame(random.below(kBatch)),
        tets(random_tets(random, count)),
        nodes(random.floats(std::size_t{3} * kBatch * count, -1, 1)),
        rotations(std::size_t{9} * tets.tet_count()) {
    cpu::jiggle_tet_rotate(tets, of_frame(nodes, tets.nodes.size(), frame), rotations);
  }

  // Deformation gradient of a tet.
  Eigen::Matrix3d gradient(std::size_t tet) const {
    const std::span<const float> x = of_frame(nodes, tets.nodes.size(), frame);
    const std::uint32_t* corners = tets.tets.data() + 4 * tet;
    return tet_edges(x, corners) * tet_edges(tets.nodes, corners).inverse();
  }

  Random random;
  std::uint32_t frame;
  TetTable tets;
  std::vector<float> nodes;
  std::vector<float> rotations;  // by the reference
};

// The gradients have the same bits; rot() has divisions and roots of a few ulp, which count for more where other
// rotations are almost as near.
void expect_rotations(const Case& c, const std::vector<float>& found, double tolerance) {
  for (std::size_t t = 0; t < c.tets.tet_count(); ++t) {
    const double gap = rotation_gap(c.gradient(t));
    if (gap < 0.01) continue;
    ASSERT_LT(gap * (matrix_of(found, t) - matrix_of(c.rotations, t)).norm(), tolerance) << "tet " << t;
  }
}

const bool added = add_kernel_cases("jiggle_tet_rotate", "nodes", [](KernelSet& kernels, const Trial& trial) {
  const Case c(trial.size);
  return run_on<vulkan::JiggleTetRotate>(
      kernels, {c.tets.tet_count(), trial.size, c.frame}, 1,
      {{.values = c.rotations,
        .compare = [c](const std::vector<float>& found, double tolerance) { expect_rotations(c, found, tolerance); }}},
      c.tets.tets, c.tets.shapes, c.nodes);
});

TEST(JiggleTetRotateReference, IsTheNearestRotation) {
  const Case c(300);
  std::size_t compared = 0;
  for (std::size_t t = 0; t < c.tets.tet_count(); ++t) {
    const double gap = rotation_gap(c.gradient(t));
    if (gap < 0.05) continue;
    ++compared;
    ASSERT_LT(gap * (matrix_of(c.rotations, t) - nearest_rotation(c.gradient(t))).norm(), 1e-5) << "tet " << t;
  }
  EXPECT_GT(compared, 150u);
}

}  // namespace jiggle_tet_rotate_test
}  // namespace bodyopt::testing
