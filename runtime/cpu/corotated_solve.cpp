#include "runtime/cpu/corotated_solve.h"

#include "runtime/cpu/dynamics_kernels.h"

namespace bodyopt::cpu {
namespace {

void multiply(const CorotatedOperator& a, std::span<const float> direction, std::vector<float>& tractions,
              std::span<float> product, Executor& threads) {
  jiggle_stress(a.tets, a.jiggle, a.rotations, a.tet_rotations, direction, tractions, threads);
  jiggle_force(a.tets, a.jiggle, a.rotations, tractions, direction, product, threads);
}

}  // namespace

void corotated_start(const JiggleStepPush& stage, std::span<const float> local_displacement,
                     std::span<const float> local_velocity, std::span<float> start) {
  const float velocity_weight = stage.stage * stage.stage * stage.velocity_weight;
  for (std::size_t k = 0; k < start.size(); ++k) {
    start[k] = stage.displacement_weight * local_displacement[k] + velocity_weight * local_velocity[k];
  }
}

void corotated_solve(const CorotatedOperator& a, std::span<const float> right_side, std::uint32_t iterations,
                     CorotatedScratch& scratch, std::span<float> solution, Executor& threads) {
  auto& [residual, y, direction, product, tractions, block] = scratch;
  for (std::vector<float>* values : {&residual, &y, &direction, &product}) values->assign(right_side.size(), 0.0f);
  tractions.resize(a.tet_rotations.size());
  const BlockInverse& inverse = a.jiggle.inverse;

  multiply(a, solution, tractions, product, threads);
  for (std::size_t k = 0; k < residual.size(); ++k) residual[k] = right_side[k] - product[k];
  float rho[1] = {0}, next_rho[1], pq[1];
  for (std::uint32_t i = 0; i < iterations; ++i) {
    block_solve(inverse, residual, 1, 1, block, y, threads);
    conjugate_dot(residual, y, next_rho);
    conjugate_direction(rho, next_rho, y, direction, direction, threads);  // rho is 0 at first: y
    rho[0] = next_rho[0];
    multiply(a, direction, tractions, product, threads);
    conjugate_dot(direction, product, pq);
    conjugate_step(rho, pq, direction, product, solution, residual, solution, residual, threads);
  }
}

}  // namespace bodyopt::cpu
