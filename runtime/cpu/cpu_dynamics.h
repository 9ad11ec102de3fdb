// Diffuse and jiggle on the CPU: their kernels one after the other.
#pragma once

#include "runtime/host/backend.h"

namespace bodyopt {

class CpuDynamics {
 public:
  // The executor must outlive it.
  CpuDynamics(const JiggleModel& model, Executor& threads);

  // The nodes of a batch, kept for jiggle(). positions: F x V x 3, of the quasi-static skin.
  void diffuse(const Batch& batch, std::span<const float> positions);
  // Steps the frames of the batch in their order. Replaces `positions`, F x V x 3, of the quasi-static skin by those of
  // the skin that jiggles, shown by `weight`. `strains`: F x S. Where it throws, the motion is that of before.
  void jiggle(const Batch& batch, float weight, std::span<const float> strains, std::vector<float>& positions);

  NodeMotion motion;

 private:
  void step_frames(const Batch& batch, float weight, std::span<const float> strains, std::vector<float>& positions);
  void step(const Batch& batch, std::uint32_t frame, std::span<const float> strains);
  void begin_frame(const JiggleFrame& frame, std::span<const float> nodes);
  void solve();

  const Dynamics& dynamics_;
  Executor& threads_;
  const JiggleOptions options_;
  std::size_t numbers_;                                         // 3 N
  std::vector<float> nodes_, rotations_, diffuse_right_sides_;  // of the batch
  std::vector<float> u_, v_, next_u_, next_v_;                  // of a stage, in the nodes' frames
  std::vector<float> right_side_, solution_, scratch_;
  std::vector<float> moved_;  // the skin of the batch
  NodeMotion next_, before_;
};

}  // namespace bodyopt
