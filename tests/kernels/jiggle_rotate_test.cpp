#include <Eigen/Geometry>

#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tets.h"
#include "tests/support/textbook_ddm.h"

namespace bodyopt::testing {
namespace jiggle_rotate_test {

Eigen::Matrix3d turn(Random& random) {
  const Quat q = random.turn(3.0);
  return Eigen::Quaterniond(q[3], q[0], q[1], q[2]).toRotationMatrix();
}

// Nodes turned, another turn each frame, and moved by up to `noise`.
struct Case {
  Case(std::uint32_t node_count, std::uint32_t frame_count, double noise)
      : random(node_count + 31 * frame_count), frames(frame_count), tets(random_tets(random, node_count)) {
    for (std::uint32_t f = 0; f < frames; ++f) {
      turns.push_back(turn(random));
      for (std::size_t n = 0; n < node_count; ++n) {
        append_point(nodes, turns.back() * point_of(tets.nodes, n) +
                                Eigen::Vector3d::NullaryExpr([&] { return random.uniform(-noise, noise); }));
      }
    }
    rotations.resize(3 * nodes.size());
    cpu::jiggle_rotate(tets, nodes, frames, rotations);
  }

  // Of node k, counted over the frames.
  Eigen::Matrix3d rotation(std::size_t k) const {
    return Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(rotations.data() + 9 * k).cast<double>();
  }

  Random random;
  std::uint32_t frames;
  TetTable tets;
  std::vector<Eigen::Matrix3d> turns;
  std::vector<float> nodes;
  std::vector<float> rotations;  // by the reference
};

const bool added = add_kernel_cases_of_frames("jiggle_rotate", "nodes", [](KernelSet& kernels, const Trial& trial) {
  const Case c(trial.size, trial.variant, 0.05);
  // The gradients have the same bits, rot() has divisions and roots of a few ulp; see rotation_test for its error.
  return run_on<vulkan::JiggleRotate>(kernels, {trial.size}, c.frames, {{c.rotations}}, c.tets.tets, c.tets.shapes,
                                      c.tets.corner_begin, c.tets.corners, c.nodes);
});

TEST(JiggleRotateReference, EqualsTheTextbook) {
  const Case c(300, 2, 0.05);
  std::size_t compared = 0;
  for (std::size_t k = 0; k < 300 * c.frames; ++k) {
    const std::size_t node = k % 300, first = 300 * (k / 300);
    const std::vector<float> nodes(c.nodes.begin() + static_cast<std::ptrdiff_t>(3 * first), c.nodes.end());
    Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
    for (std::size_t t = 0; t < c.tets.tets.size() / 4; ++t) {
      const std::uint32_t* tet = c.tets.tets.data() + 4 * t;
      if (std::find(tet, tet + 4, node) == tet + 4) continue;
      const Eigen::Matrix3d rest = tet_edges(c.tets.nodes, tet);
      mean += rest.determinant() / 6 * tet_edges(nodes, tet) * rest.inverse();
    }
    const double gap = rotation_gap(mean);
    if (gap < 0.05) continue;
    ++compared;
    ASSERT_LT(gap * (c.rotation(k) - nearest_rotation(mean)).norm(), 1e-5) << "node " << node << ", gap " << gap;
  }
  EXPECT_GT(compared, 300 * c.frames * 9 / 10);
}

// A rigid motion turns every node by its rotation; a node of no tet is not turned.
TEST(JiggleRotateReference, RigidMotionGivesItsRotation) {
  const Case c(300, 2, 0);
  std::size_t loose = 0;
  for (std::size_t k = 0; k < 300 * c.frames; ++k) {
    const bool in_tets = c.tets.corner_begin[k % 300] < c.tets.corner_begin[k % 300 + 1];
    loose += !in_tets;
    const Eigen::Matrix3d expected = in_tets ? c.turns[k / 300] : Eigen::Matrix3d::Identity();
    ASSERT_LE((c.rotation(k) - expected).norm(), in_tets ? 4e-6 : 0.0);
  }
  EXPECT_GT(loose, 0u);
}

}  // namespace jiggle_rotate_test
}  // namespace bodyopt::testing
