#include "runtime/cpu/cpu_dynamics.h"

#include "runtime/basis/dynamics.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/parallel.h"
#include "runtime/host/jiggle.h"

namespace bodyopt {

using cpu::of_frame;

CpuDynamics::CpuDynamics(const JiggleModel& model, Executor& threads)
    : dynamics_(*model.dynamics), threads_(threads), options_(model.options), numbers_(dynamics_.tets.nodes.size()) {
  for (std::vector<float>* values :
       {&motion.displacement, &motion.velocity, &motion.nodes, &motion.node_velocity, &next_.displacement,
        &next_.velocity, &next_.nodes, &next_.node_velocity, &u_, &v_, &next_u_, &next_v_, &right_side_, &solution_}) {
    values->assign(numbers_, 0.0f);
  }
}

void CpuDynamics::jiggle(const Batch& batch, float weight, std::span<const float> strains,
                         std::vector<float>& positions) {
  before_ = motion;
  try {
    step_frames(batch, weight, strains, positions);
  } catch (...) {
    motion = before_;
    throw;
  }
}

void CpuDynamics::step_frames(const Batch& batch, float weight, std::span<const float> strains,
                              std::vector<float>& positions) {
  rotations_.resize(3 * nodes_.size());
  cpu::jiggle_rotate(dynamics_.tets, nodes_, batch.frame_count, rotations_, threads_);
  moved_.resize(positions.size());
  for (std::uint32_t f = 0; f < batch.frame_count; ++f) {
    step(batch, f, of_frame(strains, f, batch.frame_count));
    cpu::jiggle_skin(dynamics_.tets, of_frame(positions, f, batch.frame_count), motion.displacement, weight,
                     of_frame(moved_, f, batch.frame_count), threads_);
  }
  positions.swap(moved_);
}

void CpuDynamics::diffuse(const Batch& batch, std::span<const float> positions) {
  const std::uint32_t frames = batch.frame_count;
  nodes_.resize(numbers_ * frames);
  diffuse_right_sides_.resize(nodes_.size());
  cpu::diffuse_surface(dynamics_.tets, positions, batch.origins, frames, nodes_, threads_);
  cpu::diffuse_gather(dynamics_.diffuse, dynamics_.tets.surface_count(), nodes_, frames, diffuse_right_sides_,
                      threads_);
  cpu::block_solve(dynamics_.diffuse.inverse, diffuse_right_sides_, 3 * frames, 3, scratch_, nodes_, threads_);
}

void CpuDynamics::begin_frame(const JiggleFrame& frame, std::span<const float> nodes) {
  JiggleKickPush kick = frame.kick;
  kick.node_count = dynamics_.tets.node_count();
  cpu::jiggle_kick(kick, nodes, {motion.displacement, motion.velocity, motion.nodes, motion.node_velocity},
                   {next_.displacement, next_.velocity, next_.nodes, next_.node_velocity}, threads_);
  std::swap(motion, next_);
}

void CpuDynamics::step(const Batch& batch, std::uint32_t f, std::span<const float> strains) {
  const JiggleFrame& frame = batch.jiggle[f];
  if (frame.repeats) return;
  const std::span<const float> nodes = of_frame(nodes_, f, batch.frame_count);
  const std::span<const float> rotations = of_frame(rotations_, f, batch.frame_count);
  const std::span<const float> controls = of_frame(batch.controls, f, batch.frame_count);
  begin_frame(frame, nodes);
  const JiggleStepPush push = jiggle_frame(dynamics_, static_cast<std::uint32_t>(strains.size()),
                                           static_cast<std::uint32_t>(controls.size()), 0, options_.gravity_change);
  const JiggleTable& jiggle = dynamics_.jiggle;
  const JiggleStages stages = jiggle_stages(jiggle.step, push);
  for (std::uint32_t s = 0; s < frame.steps; ++s) {
    cpu::jiggle_begin(jiggle, stages.begin, rotations, strains, controls, motion.displacement, motion.velocity, u_, v_,
                      right_side_, threads_);
    solve();
    if (stages.advance) {
      cpu::jiggle_advance(jiggle, *stages.advance, rotations, solution_, u_, v_, next_u_, next_v_, right_side_,
                          threads_);
      u_.swap(next_u_);
      v_.swap(next_v_);
      solve();
    }
    cpu::jiggle_end(stages.end, rotations, solution_, u_, motion.displacement, motion.velocity, threads_);
  }
}

void CpuDynamics::solve() {
  cpu::block_solve(dynamics_.jiggle.inverse, right_side_, 1, 1, scratch_, solution_, threads_);
}

}  // namespace bodyopt
