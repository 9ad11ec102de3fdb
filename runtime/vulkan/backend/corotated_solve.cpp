#include "runtime/vulkan/backend/corotated_solve.h"

#include <utility>

#include "runtime/host/jiggle_stages.h"
#include "runtime/vulkan/kernels/jiggle_tables.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {
namespace {

Buffer number(const Device& device, float value) {
  return upload(device, std::vector<float>{value}, "a number of the conjugate gradients");
}

}  // namespace

CorotatedSolve::CorotatedSolve(const Device& device, const TetTable& tets, const JiggleTable& jiggle,
                               const Tables& tables, const DeviceInfo& limits)
    : tables_(tables),
      node_count_(tets.node_count()),
      tet_count_(tets.tet_count()),
      tet_rotate_(device),
      stress_(device),
      force_(device),
      dot_(device),
      step_(device),
      direction_(device),
      block_(device),
      elasticity_(upload_whole(device, jiggle.elasticity, "the tets' elasticity", limits)),
      rows_(upload_whole(device, node_rows(tets, jiggle), "the nodes' tets and springs", limits)),
      held_(upload_whole(device, held_nodes(jiggle), "the held nodes", limits)),
      one_(number(device, 1)),
      zeros_(upload(device, std::vector<float>(std::size_t{3} * node_count_), "zeros")),
      tet_rotations_(floats(device, std::uint64_t{9} * tet_count_, "the tets' rotations")),
      tractions_(floats(device, std::uint64_t{9} * tet_count_, "the tets' tractions")),
      residual_(floats(device, std::uint64_t{3} * node_count_, "the conjugate gradients")),
      y_(floats(device, std::uint64_t{3} * node_count_, "the conjugate gradients")),
      search_(floats(device, std::uint64_t{3} * node_count_, "the conjugate gradients")),
      product_(floats(device, std::uint64_t{3} * node_count_, "the conjugate gradients")),
      gathered_(floats(device, tables.inverse.slot_count, "the block inverse's sums")),
      results_(floats(device, tables.inverse.slot_count, "the block inverse's sums")),
      rho_(floats(device, 1, "the conjugate gradients")),
      next_rho_(floats(device, 1, "the conjugate gradients")),
      pq_(floats(device, 1, "the conjugate gradients")) {
  const JiggleStages stages = jiggle_stages(jiggle.step, {});
  const auto add = [&](const JiggleStepPush& stage) {
    start_weights_.push_back(
        {number(device, stage.displacement_weight), number(device, stage.stage * stage.stage * stage.velocity_weight)});
  };
  add(stages.begin);
  if (stages.advance) add(*stages.advance);
}

void CorotatedSolve::record_frame(Commands& commands, const BufferRange& nodes, std::uint32_t frame) const {
  tet_rotate_.record(commands, {tables_.tets, tables_.shapes, nodes, tet_rotations_}, {tet_count_, node_count_, frame});
}

// y + beta p with beta = weight / 1, twice.
void CorotatedSolve::record_start(Commands& commands, std::size_t stage, const BufferRange& local_displacement,
                                  const BufferRange& local_velocity, const BufferRange& start) const {
  const StartWeights& weights = start_weights_[stage];
  direction_.record(commands, {one_, weights.displacement, zeros_, local_displacement, start}, {3 * node_count_});
  direction_.record(commands, {one_, weights.velocity, start, local_velocity, start}, {3 * node_count_});
}

void CorotatedSolve::record(Commands& commands, const BufferRange& rotations, std::uint32_t frame,
                            const BufferRange& right_side, std::uint32_t iterations,
                            const BufferRange& solution) const {
  const ConjugatePush push{3 * node_count_};
  for (const Buffer* buffer : {&y_, &search_, &rho_}) commands.fill(*buffer, 0);
  record_product(commands, rotations, frame, solution);
  // A step of length 1 from zeros: the solution stays as it is, the residual is right side - A z0.
  step_.record(commands, {one_, one_, solution, product_, zeros_, right_side, solution, residual_}, push);
  const Buffer *rho = &rho_, *next_rho = &next_rho_;
  for (std::uint32_t i = 0; i < iterations; ++i) {
    commands.cut();
    block_.record(commands, {tables_.inverse, residual_, gathered_, results_, y_}, 1, 1);
    dot_.record(commands, {residual_, y_, *next_rho}, push);
    direction_.record(commands, {*rho, *next_rho, y_, search_, search_}, push);  // rho is 0 at first: y
    std::swap(rho, next_rho);
    record_product(commands, rotations, frame, search_);
    dot_.record(commands, {search_, product_, pq_}, push);
    step_.record(commands, {*rho, pq_, search_, product_, solution, residual_, solution, residual_}, push);
  }
}

void CorotatedSolve::record_product(Commands& commands, const BufferRange& rotations, std::uint32_t frame,
                                    const BufferRange& direction) const {
  stress_.record(commands,
                 {tables_.tets, tables_.shapes, elasticity_, rotations, tet_rotations_, direction, tractions_},
                 {tet_count_, node_count_, frame});
  force_.record(commands, {tables_.shapes, rows_, tables_.corners, held_, rotations, tractions_, direction, product_},
                {node_count_, frame});
}

}  // namespace bodyopt::vulkan
