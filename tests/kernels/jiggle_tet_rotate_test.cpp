#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/gpu_fixture.h"
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

class JiggleTetRotate : public GpuTest {};

TEST_F(JiggleTetRotate, EqualsTheReference) {
  const vulkan::JiggleTetRotate kernel(*device_);
  for (const std::uint32_t count : kSizes) {
    SCOPED_TRACE(std::to_string(count) + " nodes");
    const Case c(count);
    const auto tets = vulkan::upload(*device_, c.tets.tets, "tets"),
               shapes = vulkan::upload(*device_, c.tets.shapes, "shapes"),
               nodes = vulkan::upload(*device_, c.nodes, "nodes");
    const auto outputs = run_kernel(*device_, {c.rotations.size()}, [&](auto& commands, const auto& out) {
      kernel.record(commands, {tets, shapes, nodes, out[0]}, {c.tets.tet_count(), count, c.frame});
    });
    // The gradients have the same bits; rot() has divisions and roots of a few ulp, which count for more where other
    // rotations are almost as near.
    for (std::size_t t = 0; t < c.tets.tet_count(); ++t) {
      const double gap = rotation_gap(c.gradient(t));
      if (gap < 0.01) continue;
      ASSERT_LT(gap * (matrix_of(outputs[0], t) - matrix_of(c.rotations, t)).norm(), 1e-5) << "tet " << t;
    }
  }
}

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
