#include <Eigen/Core>

#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/simulate/tet_block.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tets.h"
#include "tests/support/textbook_algebra.h"

namespace bodyopt::testing {
namespace diffuse_gather_test {

constexpr std::uint32_t kSurface = 40;

struct Case {
  Case(std::uint32_t inside, std::uint32_t frame_count)
      : random(inside + 31 * frame_count),
        frames(frame_count),
        node_count(kSurface + inside),
        nodes(random.floats(std::size_t{3} * node_count * frames, -1, 1)),
        before(random.floats(nodes.size(), -1, 1)),
        right_sides(before) {
    diffuse.row_begin.assign(kSurface + 1, 0);
    for (std::uint32_t n = 0; n < inside; ++n) {
      for (std::uint32_t k = random.below(9); k > 0; --k) {
        diffuse.columns.push_back(random.below(kSurface));
        diffuse.values.push_back(static_cast<float>(random.uniform(-1, 1)));
      }
      diffuse.row_begin.push_back(static_cast<std::uint32_t>(diffuse.columns.size()));
    }
    cpu::diffuse_gather(diffuse, kSurface, nodes, frames, right_sides);
  }

  Random random;
  std::uint32_t frames, node_count;
  DiffuseTable diffuse;
  std::vector<float> nodes, before;
  std::vector<float> right_sides;  // by the reference
};

const bool added = add_kernel_cases_of_frames("diffuse_gather", "nodes", [](KernelSet& kernels, const Trial& trial) {
  const Case c(trial.size, trial.variant);
  // Sums and products in one order; nodes on the skin are left.
  return run_on<vulkan::DiffuseGather>(kernels, {kSurface, c.node_count}, c.frames,
                                       {{.values = c.right_sides, .before = c.before}}, c.diffuse.row_begin,
                                       c.diffuse.columns, c.diffuse.values, c.nodes);
});

// The Laplacian of a block of tets, nodes on its skin first, knows affine maps: with the skin's nodes mapped, the
// solution inside is the map too.
TEST(DiffuseGatherReference, SolvesToAnAffineMap) {
  constexpr int kCubes = 5;
  const TetMesh block = tet_block(kCubes, kCubes, kCubes, 0.1);
  std::vector<Eigen::Index> order;
  for (const bool on_skin : {true, false}) {
    for (Eigen::Index n = 0; n < block.nodes.rows(); ++n) {
      const double low = block.nodes.row(n).minCoeff(), high = block.nodes.row(n).maxCoeff();
      if ((low < 1e-9 || high > 0.1 * kCubes - 1e-9) == on_skin) order.push_back(n);
    }
  }
  const auto count = static_cast<Eigen::Index>(order.size()),
             inside = Eigen::Index{(kCubes - 1) * (kCubes - 1) * (kCubes - 1)}, surface = count - inside;
  std::vector<Eigen::Index> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    place[static_cast<std::size_t>(order[k])] = static_cast<Eigen::Index>(k);
  Eigen::MatrixXd laplacian = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index t = 0; t < block.tets.rows(); ++t) {
    const Eigen::Matrix3d edges = bodyopt::tet_edges(block, t);
    Eigen::Matrix<double, 4, 3> gradients;
    gradients.bottomRows<3>() = edges.inverse();
    gradients.row(0) = -gradients.bottomRows<3>().colwise().sum();
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        laplacian(place[static_cast<std::size_t>(block.tets(t, a))],
                  place[static_cast<std::size_t>(block.tets(t, b))]) +=
            edges.determinant() / 6 * gradients.row(a).dot(gradients.row(b));
      }
    }
  }
  DiffuseTable diffuse;
  diffuse.row_begin.assign(static_cast<std::size_t>(surface) + 1, 0);
  for (Eigen::Index n = surface; n < count; ++n) {
    for (Eigen::Index s = 0; s < surface; ++s) {
      if (laplacian(n, s) == 0) continue;
      diffuse.columns.push_back(static_cast<std::uint32_t>(s));
      diffuse.values.push_back(static_cast<float>(-laplacian(n, s)));
    }
    diffuse.row_begin.push_back(static_cast<std::uint32_t>(diffuse.columns.size()));
  }
  Random random(3);
  const Eigen::Matrix3d map = Eigen::Matrix3d::NullaryExpr([&] { return random.uniform(-1, 1); });
  const Eigen::Vector3d offset(0.3, -0.2, 0.5);
  std::vector<float> nodes;
  for (const Eigen::Index n : order) append_point(nodes, map * block.nodes.row(n).transpose() + offset);
  std::vector<float> right_sides(nodes.size());
  cpu::diffuse_gather(diffuse, static_cast<std::uint32_t>(surface), nodes, 1, right_sides);
  Eigen::MatrixXd right_side(inside, 3);
  for (Eigen::Index k = 0; k < inside; ++k) {
    right_side.row(k) = point_of(right_sides, static_cast<std::size_t>(surface + k)).transpose();
  }
  const Eigen::MatrixXd solution = textbook_solve(laplacian.bottomRightCorner(inside, inside), right_side);
  for (Eigen::Index k = 0; k < inside; ++k) {
    EXPECT_LT((solution.row(k).transpose() - point_of(nodes, static_cast<std::size_t>(surface + k))).norm(), 1e-6);
  }
}

}  // namespace diffuse_gather_test
}  // namespace bodyopt::testing
