#include "runtime/vulkan/backend/corotated_solve.h"

#include "runtime/cpu/corotated_solve.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/host/jiggle_stages.h"
#include "tests/support/corotated_matrix.h"
#include "tests/support/cut_executor.h"
#include "tests/support/gpu_fixture.h"
#include "trainer/dynamics/block_inverse.h"

namespace bodyopt::testing {
namespace {

// A bar of tets, bent by an angle over its length.
struct Bar {
  explicit Bar(double angle) : random(5), tets(block_tets(8, 2, 2)), jiggle(random_corotated(random, tets)) {
    const std::uint32_t count = tets.node_count();
    for (TetElasticity& e : jiggle.elasticity) e = {40 * e.lambda, 40 * e.mu};  // against a held value of about 1
    for (std::size_t n = 0; n < count; ++n) {
      const Eigen::Vector3d x = point_of(tets.nodes, n);
      const double a = angle * x[0] / 8, radius = angle == 0 ? 0 : 8 / angle + x[1];
      append_point(bent, angle == 0 ? x : Eigen::Vector3d(radius * std::sin(a), radius * std::cos(a), x[2]));
    }
    rotations.resize(std::size_t{9} * count);
    tet_rotations.resize(std::size_t{9} * tets.tet_count());
    cpu::jiggle_rotate(tets, bent, 1, rotations);
    cpu::jiggle_tet_rotate(tets, bent, tet_rotations);
    matrix = corotated_matrix(tets, jiggle, rotations, tet_rotations);
    const Eigen::MatrixXd rest = corotated_matrix(tets, jiggle, unturned(count), unturned(tets.tet_count()));
    Positions points(count, 3);
    for (std::size_t n = 0; n < count; ++n) points.row(static_cast<Eigen::Index>(n)) = point_of(tets.nodes, n);
    jiggle.nodes = random_jiggle_nodes(random, count, 1, 0);
    jiggle.inverse = invert(rest.sparseView(), points, 3);
    right_side = random.floats(std::size_t{3} * count, -1, 1);
  }

  static std::vector<float> unturned(std::uint32_t count) {
    std::vector<float> rotations(std::size_t{9} * count, 0.0f);
    for (std::size_t k = 0; k < rotations.size(); ++k) rotations[k] = k % 9 % 4 == 0 ? 1.0f : 0.0f;
    return rotations;
  }

  std::vector<float> solve(std::uint32_t iterations, std::vector<float> solution,
                           Executor& threads = calling_thread()) const {
    cpu::CorotatedScratch scratch;
    cpu::corotated_solve({tets, jiggle, rotations, tet_rotations}, right_side, iterations, scratch, solution, threads);
    return solution;
  }

  // Relative error of the solution from a start.
  double error(std::uint32_t iterations, const std::vector<float>& start) const {
    const Eigen::VectorXd exact = matrix.llt().solve(doubles(right_side));
    return (doubles(solve(iterations, start)) - exact).norm() / exact.norm();
  }

  Random random;
  TetTable tets;
  JiggleTable jiggle;
  std::vector<float> bent, rotations, tet_rotations, right_side;
  Eigen::MatrixXd matrix;
};

TEST(CorotatedSolve, OneIterationWhereNothingIsTurned) {
  const Bar bar(0);
  EXPECT_LT(bar.error(1, std::vector<float>(bar.right_side.size())), 1e-5);
}

TEST(CorotatedSolve, ConvergesToTheCorotatedSolution) {
  const Bar bar(1.5);
  const std::vector<float> zeros(bar.right_side.size()), start = Random(9).floats(zeros.size(), -1, 1);
  EXPECT_GT(bar.error(1, zeros), 1e-2);  // the block inverse alone is not the answer
  for (const std::vector<float>& from : {zeros, start}) {
    double last = 10;
    for (const std::uint32_t iterations : {2u, 4u, 8u, 16u}) {
      const double error = bar.error(iterations, from);
      RecordProperty("error_" + std::to_string(iterations), std::to_string(error));
      EXPECT_LT(error, last / 2);
      last = error;
    }
    EXPECT_LT(last, 1e-4);
  }
}

TEST(CorotatedSolve, NothingGivesExactlyNothing) {
  Bar bar(1.5);
  std::fill(bar.right_side.begin(), bar.right_side.end(), 0.0f);
  const std::vector<float> zeros(bar.right_side.size());
  EXPECT_EQ(bar.solve(8, zeros), zeros);
}

// Long after it has converged it still stands there.
TEST(CorotatedSolve, ManyIterationsDoNoHarm) {
  const Bar bar(1.5);
  EXPECT_LT(bar.error(200, std::vector<float>(bar.right_side.size())), 1e-5);
}

TEST(CorotatedSolve, SameBitsHoweverItIsCut) {
  const std::vector<float> start = Random(9).floats(Bar(1.5).right_side.size(), -1, 1);
  CutExecutor cut;
  EXPECT_EQ(Bar(1.5).solve(4, start), Bar(1.5).solve(4, start, cut));
  EXPECT_GT(cut.calls, 0u);
}

// Without stiffness and damping the start is the solution.
TEST(CorotatedSolve, StartIsTheSolutionWithoutStiffness) {
  Random random(3);
  JiggleStepPush stage = random_step(random, 1, 0, 1, 0);
  stage.gravity_x = stage.gravity_y = stage.gravity_z = 0;
  JiggleTable jiggle;
  jiggle.nodes = random_jiggle_nodes(random, 1, 1, 0);
  jiggle.nodes[0].inertia = jiggle.nodes[0].mass / (stage.stage * stage.stage);
  const std::vector<float> u = random.floats(3, -1, 1), v = random.floats(3, -1, 1);
  std::vector<float> local_u(3), local_v(3), right_side(3), start(3);
  cpu::jiggle_begin(jiggle, stage, Bar::unturned(1), {}, {}, u, v, local_u, local_v, right_side);
  cpu::corotated_start(stage, local_u, local_v, start);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(start[i], right_side[i] / jiggle.nodes[0].inertia, 1e-6);
}

class CorotatedSolveOnDevice : public GpuTest {};

// From the nodes on, in the second frame of a batch: start, rotations of the tets, iterations.
TEST_F(CorotatedSolveOnDevice, EqualsTheReference) {
  Bar bar(1.5);
  const std::size_t size = bar.right_side.size();
  const std::vector<float> u = bar.random.floats(size, -1, 1), v = bar.random.floats(size, -1, 1);
  const auto batch = [](const std::vector<float>& of_frame) {
    std::vector<float> both(of_frame.size(), 7.0f);
    both.insert(both.end(), of_frame.begin(), of_frame.end());
    return both;
  };
  const auto tets = vulkan::upload(*device_, bar.tets.tets, "tets"),
             shapes = vulkan::upload(*device_, bar.tets.shapes, "shapes"),
             corners = vulkan::upload(*device_, bar.tets.corners, "corners"),
             nodes = vulkan::upload(*device_, batch(bar.bent), "nodes"),
             rotations = vulkan::upload(*device_, batch(bar.rotations), "rotations"),
             local_u = vulkan::upload(*device_, u, "displacement"), local_v = vulkan::upload(*device_, v, "velocity"),
             right_side = vulkan::upload(*device_, bar.right_side, "right side");
  const vulkan::InverseBuffers inverse(*device_, bar.jiggle.inverse, device_->info());
  const vulkan::CorotatedSolve solve(*device_, bar.tets, bar.jiggle, {tets, shapes, corners, inverse}, device_->info());
  const JiggleStages stages = jiggle_stages(bar.jiggle.step, {});
  for (const std::size_t stage : {0u, 1u}) {
    std::vector<float> start(size);
    cpu::corotated_start(stage == 0 ? stages.begin : *stages.advance, u, v, start);
    for (const std::uint32_t iterations : {0u, 1u, 6u}) {
      SCOPED_TRACE("stage " + std::to_string(stage) + ", " + std::to_string(iterations) + " iterations");
      const auto outputs = run_kernel(*device_, {size}, [&](auto& commands, const auto& out) {
        solve.record_start(commands, stage, local_u, local_v, out[0]);
        solve.record_frame(commands, nodes, 1);
        solve.record(commands, rotations, 1, right_side, iterations, out[0]);
      });
      // The tets' rotations and the iterations' quotients differ by a few ulp.
      expect_close(outputs[0], bar.solve(iterations, start), iterations == 0 ? 0 : 1e-5);
    }
  }
}

}  // namespace
}  // namespace bodyopt::testing
