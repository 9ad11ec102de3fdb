// Diffuse and jiggle on a Vulkan device, as runtime/cpu/cpu_dynamics.h: the motion is kept on the device from batch to
// batch.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "runtime/host/backend.h"
#include "runtime/host/jiggle.h"
#include "runtime/vulkan/backend/device_model.h"

namespace bodyopt::vulkan {

class VulkanDynamics {
 public:
  // Results of earlier stages of a batch, on the device.
  struct Inputs {
    BufferRange positions;  // F x V x 3, of the quasi-static skin
    BufferRange origins;    // F x 4
    BufferRange strains;    // F x fibre_count
    BufferRange controls;   // F x control_count
    std::uint32_t fibre_count, control_count, frame_count;
  };

  // The model must have dynamics, and outlive it. Throws Error(device).
  VulkanDynamics(const DeviceModel& model, const JiggleOptions& options);

  // Floats on the device per frame of a batch.
  std::uint64_t frame_floats() const;
  // Most frames of a batch, but for memory.
  std::uint64_t batch_limit() const;

  // Allocates what batches of at most so many frames need; before their recording.
  void prepare(std::uint32_t most_frames);
  void record_diffuse(Commands& commands, const Inputs& inputs) const;
  // Cuts the commands: what they read from the host must be there already. The motion is that of the last frame from
  // here on, as if the commands had run. `weight`: how much of it the skin shows.
  void record_jiggle(Commands& commands, const Inputs& inputs, std::span<const JiggleFrame> frames, float weight);
  // F x V x 3: the skin that jiggles.
  const Buffer& moved() const { return batch_->moved; }

  // Records a copy of the motion for the host, in commands that run before it is asked for.
  void record_motion(Commands& commands);

  void set_motion(const NodeMotion& motion);
  NodeMotion motion() const;  // of the last record_motion(), or, where there was none since, waits for a copy

 private:
  struct BatchBuffers {
    std::uint32_t frames;
    Buffer nodes, right_sides, rotations, moved;
    Buffer gathered, results;  // of the solve
  };

  // The motion in the nodes' frames.
  struct Local {
    Local(const Device& device, std::uint64_t numbers);

    Buffer displacement, velocity;
  };

  void record_kick(Commands& commands, const JiggleFrame& frame, std::uint32_t number);
  void record_step(Commands& commands, const Inputs& inputs, const JiggleStages& stages) const;
  void record_solve(Commands& commands) const;

  const Device& device_;
  const DeviceInfo& limits_;  // of what a binding sees
  const Dynamics& dynamics_;
  const JiggleOptions options_;
  std::uint32_t node_count_, vertex_count_;
  const DynamicsTables& tables_;
  const DynamicsKernels& kernels_;
  std::array<Buffer, 2>
      motions_;                 // kMotionDisplacement and the like; of the last frame, and of the one before or after
  std::size_t current_ = 0;     // motion that is of the last frame
  Buffer downloaded_;           // staged
  bool is_downloaded_ = false;  // the current one
  std::array<Local, 2> local_;  // of the two stages of a step
  Buffer right_side_, solution_, gathered_, results_;
  std::optional<BatchBuffers> batch_;
};

}  // namespace bodyopt::vulkan
