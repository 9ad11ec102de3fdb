// Quality mode of the jiggle on the device: runtime/cpu/corotated_solve.h, kernel by kernel.
#pragma once

#include <vector>

#include "runtime/basis/dynamics.h"
#include "runtime/vulkan/backend/block_solve.h"
#include "runtime/vulkan/kernels/kernels.h"

namespace bodyopt::vulkan {

class CorotatedSolve {
 public:
  // Of the dynamics, on the device.
  struct Tables {
    BufferRange tets, shapes, corners;
    const InverseBuffers& inverse;  // of the jiggle
  };

  // `tables` must outlive it; `limits`: of the device's bindings. Throws Error(device).
  CorotatedSolve(const Device& device, const TetTable& tets, const JiggleTable& jiggle, const Tables& tables,
                 const DeviceInfo& limits);

  // Once a frame: rotations of its tets. nodes: of the batch.
  void record_frame(Commands& commands, const BufferRange& nodes, std::uint32_t frame) const;

  // cpu::corotated_start of stage 0 (that of jiggle_begin) or 1 (that of jiggle_advance).
  void record_start(Commands& commands, std::size_t stage, const BufferRange& local_displacement,
                    const BufferRange& local_velocity, const BufferRange& start) const;

  // cpu::corotated_solve, the commands cut between iterations: `solution`, z0 before, is z afterwards. rotations: of
  // the nodes, of the batch.
  void record(Commands& commands, const BufferRange& rotations, std::uint32_t frame, const BufferRange& right_side,
              std::uint32_t iterations, const BufferRange& solution) const;

 private:
  // One number each.
  struct StartWeights {
    Buffer displacement, velocity;
  };

  void record_product(Commands& commands, const BufferRange& rotations, std::uint32_t frame,
                      const BufferRange& direction) const;

  Tables tables_;
  std::uint32_t node_count_, tet_count_;
  JiggleTetRotate tet_rotate_;
  JiggleStress stress_;
  JiggleForce force_;
  ConjugateDot dot_;
  ConjugateStep step_;
  ConjugateDirection direction_;
  BlockSolve block_;
  Buffer elasticity_, rows_, held_;
  std::vector<StartWeights> start_weights_;  // of each stage
  Buffer one_, zeros_;                       // 1; 3 N times 0
  Buffer tet_rotations_, tractions_, residual_, y_, search_, product_, gathered_, results_, rho_, next_rho_, pq_;
};

}  // namespace bodyopt::vulkan
