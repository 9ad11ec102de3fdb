#include "runtime/vulkan/backend/vulkan_dynamics.h"

#include <algorithm>
#include <cstring>

#include "shaders/include/layout.h"

namespace bodyopt::vulkan {
namespace {

// Solves of a batch where no frame is left out: an interrupted shot ends soon.
constexpr std::uint32_t kBatchSolves = 128;

// The parts are in the order of kMotionDisplacement and the like.
constexpr std::vector<float> NodeMotion::*kMotionParts[] = {&NodeMotion::displacement, &NodeMotion::velocity,
                                                            &NodeMotion::nodes, &NodeMotion::node_velocity};

std::vector<float> joined(const NodeMotion& motion) {
  std::vector<float> numbers;
  for (const auto part : kMotionParts) numbers.insert(numbers.end(), (motion.*part).begin(), (motion.*part).end());
  return numbers;
}

Buffer rest(const Device& device, std::size_t numbers) {
  return upload(device, std::vector<float>(std::size(kMotionParts) * numbers), "the motion");
}

}  // namespace

VulkanDynamics::Local::Local(const Device& device, std::uint64_t numbers)
    : displacement(floats(device, numbers, "the displacement")), velocity(floats(device, numbers, "the velocity")) {}

VulkanDynamics::VulkanDynamics(const DeviceModel& model, const JiggleOptions& options)
    : device_(model.device()),
      limits_(model.limits()),
      dynamics_(*model.model().dynamics),
      options_(options),
      node_count_(dynamics_.tets.node_count()),
      vertex_count_(static_cast<std::uint32_t>(dynamics_.tets.skin.size())),
      tables_(model.jiggling().tables),
      kernels_(model.jiggling().kernels),
      motions_{rest(device_, dynamics_.tets.nodes.size()), rest(device_, dynamics_.tets.nodes.size())},
      downloaded_(device_, motions_[0].size(), Memory::staging, "the motion"),
      local_{Local(device_, dynamics_.tets.nodes.size()), Local(device_, dynamics_.tets.nodes.size())},
      right_side_(floats(device_, dynamics_.tets.nodes.size(), "the right side")),
      solution_(floats(device_, dynamics_.tets.nodes.size(), "the solution")),
      gathered_(floats(device_, tables_.jiggle_inverse.slot_count, "the block inverse's sums")),
      results_(floats(device_, tables_.jiggle_inverse.slot_count, "the block inverse's sums")) {}

std::uint64_t VulkanDynamics::frame_floats() const {
  return std::uint64_t{15} * node_count_ + std::uint64_t{3} * vertex_count_ +
         std::uint64_t{6} * tables_.diffuse_inverse.slot_count;
}

std::uint64_t VulkanDynamics::batch_limit() const {
  const std::uint64_t largest = std::max<std::uint64_t>(
      {std::uint64_t{9} * node_count_, std::uint64_t{3} * tables_.diffuse_inverse.slot_count, 1});
  const std::uint64_t by_range = limits_.max_storage_buffer_range / (sizeof(float) * largest);
  const std::uint64_t by_groups = device_.info().max_groups_y / 3;  // a group per right side of diffuse
  const JiggleStep& step = dynamics_.jiggle.step;
  const std::uint64_t frame_solves = std::uint64_t{step.substeps} * (step.implicit_euler ? 1 : 2);
  return std::min({by_range, by_groups, kBatchSolves / frame_solves});
}

void VulkanDynamics::prepare(std::uint32_t frames) {
  if (batch_ && batch_->frames == frames) return;
  batch_.reset();  // before the next ones are allocated
  const std::uint64_t numbers = std::uint64_t{3} * node_count_ * frames;
  const std::uint64_t sums = std::uint64_t{3} * tables_.diffuse_inverse.slot_count * frames;
  batch_.emplace(BatchBuffers{
      frames, floats(device_, numbers, "the nodes"), floats(device_, numbers, "the right sides of diffuse"),
      floats(device_, 3 * numbers, "the nodes' rotations"),
      floats(device_, std::uint64_t{3} * vertex_count_ * frames, "the skin that jiggles"),
      floats(device_, sums, "the block inverse's sums"), floats(device_, sums, "the block inverse's sums")});
}

void VulkanDynamics::record_diffuse(Commands& commands, const Inputs& inputs) const {
  const auto& [most_frames, nodes, right_sides, rotations, moved, gathered, results] = *batch_;
  const std::uint32_t frames = inputs.frame_count;
  const DynamicsTables& t = tables_;
  const std::uint32_t surface_count = dynamics_.tets.surface_count();
  kernels_.diffuse_surface.record(commands, {t.surface, inputs.positions, inputs.origins, nodes},
                                  {surface_count, vertex_count_, node_count_}, frames);
  kernels_.diffuse_gather.record(commands, {t.row_begin, t.columns, t.values, nodes, right_sides},
                                 {surface_count, node_count_}, frames);
  kernels_.block_solve.record(commands, {t.diffuse_inverse, right_sides, gathered, results, nodes}, 3 * frames, 3);
}

void VulkanDynamics::record_jiggle(Commands& commands, const Inputs& inputs, std::span<const JiggleFrame> frames,
                                   float weight) {
  is_downloaded_ = false;
  const DynamicsTables& t = tables_;
  kernels_.jiggle_rotate.record(commands,
                                {t.tets, t.shapes, t.corner_begin, t.corners, batch_->nodes, batch_->rotations},
                                {node_count_}, inputs.frame_count);
  for (std::uint32_t f = 0; f < frames.size(); ++f) {
    if (!frames[f].repeats) {
      record_kick(commands, frames[f], f);
      const JiggleStages stages =
          jiggle_stages(dynamics_.jiggle.step,
                        jiggle_frame(dynamics_, inputs.fibre_count, inputs.control_count, f, options_.gravity_change));
      for (std::uint32_t s = 0; s < frames[f].steps; ++s) {
        record_step(commands, inputs, stages);
        commands.cut();
      }
    }
    kernels_.jiggle_skin.record(commands,
                                {t.tets, t.skin, t.limit, inputs.positions, motions_[current_], batch_->moved},
                                {vertex_count_, f, weight});
  }
}

void VulkanDynamics::record_kick(Commands& commands, const JiggleFrame& frame, std::uint32_t number) {
  JiggleKickPush push = frame.kick;
  push.node_count = node_count_;
  push.frame = number;
  const Buffer& before = motions_[current_];
  current_ = 1 - current_;
  kernels_.jiggle_kick.record(commands, {batch_->nodes, before, motions_[current_]}, push);
}

void VulkanDynamics::record_step(Commands& commands, const Inputs& inputs, const JiggleStages& stages) const {
  const Buffer& motion = motions_[current_];
  const Buffer& rotations = batch_->rotations;
  const auto& [first, second] = local_;
  kernels_.jiggle_begin.record(commands,
                               {tables_.nodes, rotations, inputs.strains, inputs.controls, motion, first.displacement,
                                first.velocity, right_side_},
                               stages.begin);
  record_solve(commands);
  if (stages.advance) {
    kernels_.jiggle_advance.record(commands,
                                   {tables_.nodes, rotations, solution_, first.displacement, first.velocity,
                                    second.displacement, second.velocity, right_side_},
                                   *stages.advance);
    record_solve(commands);
  }
  const Local& last = stages.advance ? second : first;
  kernels_.jiggle_end.record(commands, {rotations, solution_, last.displacement, motion}, stages.end);
}

void VulkanDynamics::record_solve(Commands& commands) const {
  kernels_.block_solve.record(commands, {tables_.jiggle_inverse, right_side_, gathered_, results_, solution_}, 1, 1);
}

void VulkanDynamics::record_motion(Commands& commands) {
  commands.copy(motions_[current_], downloaded_);
  is_downloaded_ = true;
}

void VulkanDynamics::set_motion(const NodeMotion& motion) {
  is_downloaded_ = false;
  motions_[current_] = upload(device_, joined(motion), "the motion");
}

NodeMotion VulkanDynamics::motion() const {
  if (!is_downloaded_) {
    Commands commands(device_);
    commands.begin();
    commands.copy(motions_[current_], downloaded_);
    commands.end();
    commands.run();
  }
  NodeMotion result;
  const std::size_t numbers = dynamics_.tets.nodes.size();
  const std::byte* from = downloaded_.mapped();
  for (const auto part : kMotionParts) {
    (result.*part).resize(numbers);
    std::memcpy((result.*part).data(), from, numbers * sizeof(float));
    from += numbers * sizeof(float);
  }
  return result;
}

}  // namespace bodyopt::vulkan
