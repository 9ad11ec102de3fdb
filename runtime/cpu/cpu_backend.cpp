// The CPU as a backend: the kernels of runtime/cpu one after the other, frames in parallel.
#include "runtime/cpu/cpu_backend.h"

#include <chrono>

#include "runtime/cpu/cpu_dynamics.h"
#include "runtime/cpu/kernels.h"

namespace bodyopt {
namespace {

class CpuBackend final : public Backend {
 public:
  CpuBackend(const Basis& basis, const JiggleModel& jiggle)
      : basis_(basis), rest_coefficients_(basis.residual.coefficient_count(), 0) {
    if (jiggle.dynamics) dynamics_.emplace(jiggle);
  }

  std::string name() const override { return "cpu"; }
  std::uint32_t batch_limit() const override { return 64; }
  void set_rest_coefficients(std::span<const float> c) override { rest_coefficients_.assign(c.begin(), c.end()); }
  void set_weights(const Weights& weights) override { weights_ = weights; }
  void set_motion(const NodeMotion& motion) override { dynamics_->motion = motion; }
  NodeMotion motion() const override { return dynamics_->motion; }

  BatchResult run(const Batch& batch) override {
    const std::size_t frames = batch.frame_count;
    const std::size_t vertices = basis_.mesh.vertex_count();
    BatchResult result;
    result.positions.resize(frames * vertices * 3);
    result.normals.resize(frames * vertices * 3);
    result.strains.resize(frames * basis_.strain.fibre_count());
    result.excess.resize(frames * basis_.residual.feature_count());
    result.coefficients.resize(frames * basis_.residual.coefficient_count());
    double seconds[3] = {};
#pragma omp parallel for schedule(dynamic) reduction(+ : seconds[:3])
    for (std::size_t f = 0; f < frames; ++f) run_frame(batch, f, result, seconds);
    const char* const stages[3] = {"strain", "residual", "pose"};
    for (int s = 0; s < 3; ++s) result.stage_seconds[stages[s]] = seconds[s];
    if (!batch.jiggle.empty())
      dynamics_->run(batch, weights_.jiggle, result.strains, result.positions, result.stage_seconds);
    add_normals(frames, result);
    return result;
  }

 private:
  void run_frame(const Batch& batch, std::size_t f, BatchResult& result, double* seconds) const {
    const ResidualTable& residual = basis_.residual;
    const auto frame = [&](auto& values) {
      const std::size_t size = values.size() / batch.frame_count;
      return std::span(values).subspan(f * size, size);
    };
    const std::uint32_t joints = static_cast<std::uint32_t>(basis_.skeleton.size());
    std::vector<float> fibre_positions(3 * basis_.strain.vertices.size());
    std::vector<float> features(residual.feature_count()), coordinates(residual.coordinate_count());
    std::vector<float> kernels(residual.centre_count());
    std::vector<float> displacements(3 * std::size_t{basis_.mesh.vertex_count()});
    auto last = std::chrono::steady_clock::now();
    const auto lap = [&](int stage) {
      const auto now = std::chrono::steady_clock::now();
      seconds[stage] += std::chrono::duration<double>(now - last).count();
      last = now;
    };

    cpu::strain_skin(basis_.ddm, basis_.strain, joints, frame(batch.skinning), fibre_positions);
    cpu::strain_measure(basis_.strain, fibre_positions, frame(result.strains));
    lap(0);
    cpu::residual_features(residual, frame(batch.joint_features), frame(result.strains), frame(batch.controls), 1,
                           features, frame(result.excess));
    cpu::residual_project(residual, features, 1, coordinates);
    cpu::residual_kernels(residual, coordinates, 1, kernels);
    cpu::residual_coefficients(residual, coordinates, kernels, rest_coefficients_, frame(batch.fades), 1,
                               frame(result.coefficients));
    cpu::residual_blend(residual, frame(result.coefficients), 1, weights_.correction, displacements);
    lap(1);
    cpu::pose_skin(basis_.ddm, joints, frame(batch.skinning), frame(batch.origins), displacements,
                   frame(result.positions));
    lap(2);
  }

  void add_normals(std::size_t frames, BatchResult& result) const {
    double seconds = 0;
#pragma omp parallel for schedule(dynamic) reduction(+ : seconds)
    for (std::size_t f = 0; f < frames; ++f) {
      const auto start = std::chrono::steady_clock::now();
      const std::size_t size = result.positions.size() / frames;
      cpu::output_normals(basis_.mesh, std::span(result.positions).subspan(f * size, size),
                          std::span(result.normals).subspan(f * size, size));
      seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
    result.stage_seconds["output"] = seconds;
  }

  const Basis& basis_;
  std::vector<float> rest_coefficients_;
  Weights weights_;
  std::optional<CpuDynamics> dynamics_;
};

}  // namespace

std::unique_ptr<Backend> make_cpu_backend(const Basis& basis, const JiggleModel& jiggle) {
  return std::make_unique<CpuBackend>(basis, jiggle);
}

}  // namespace bodyopt
