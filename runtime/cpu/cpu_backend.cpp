// The CPU as a backend: the kernels of runtime/cpu one after the other, frames and blocks in parallel.
#include "runtime/cpu/cpu_backend.h"

#include <algorithm>
#include <atomic>
#include <chrono>

#include "runtime/cpu/cpu_dynamics.h"
#include "runtime/cpu/ddm_frames.h"
#include "runtime/cpu/kernels.h"

namespace bodyopt {
namespace {

// Vertices of a frame that are posed, or get their normals, at a time (and triangles, their area vectors): their
// displacements stay in the nearest cache.
constexpr std::size_t kPartBlocks = 32, kPartVertices = kPartBlocks * kBlockSize;

// Frames of a batch between whose stages what is known of their blocks is kept.
constexpr std::size_t kFramesAtOnce = 8;

struct FrameRange {
  std::size_t begin, end;
  std::size_t count() const { return end - begin; }
};

// What frame f of `frames` has of values.
template <typename Values>
auto of_frame(Values& values, std::size_t f, std::size_t frames) {
  const std::size_t size = values.size() / frames;
  return std::span(values).subspan(f * size, size);
}

// Seconds of one stage, summed over threads.
class StageTime {
 public:
  void add_since(std::chrono::steady_clock::time_point& last) {
    const auto now = std::chrono::steady_clock::now();
    seconds_.fetch_add(std::chrono::duration<double>(now - last).count(), std::memory_order_relaxed);
    last = now;
  }
  double seconds() const { return seconds_; }

 private:
  std::atomic<double> seconds_ = 0;
};

class CpuBackend final : public Backend {
 public:
  CpuBackend(const Basis& basis, const JiggleModel& jiggle, std::shared_ptr<Executor> executor)
      : basis_(basis),
        executor_(executor ? std::move(executor) : std::make_shared<SerialExecutor>()),
        rest_coefficients_(basis.residual.coefficient_count(), 0) {
    if (jiggle.dynamics) dynamics_.emplace(jiggle, *executor_);
  }

  std::string name() const override { return "cpu"; }
  std::uint32_t batch_limit() const override { return 64; }
  void set_rest_coefficients(std::span<const float> c) override { rest_coefficients_.assign(c.begin(), c.end()); }
  void set_weights(const Weights& weights) override { weights_ = weights; }
  void set_motion(const NodeMotion& motion) override { dynamics_->motion = motion; }
  NodeMotion motion() const override { return dynamics_->motion; }

  BatchResult run(const Batch& batch) override {
    const std::size_t frames = batch.frame_count;
    BatchResult result;
    result.positions.resize(frames * basis_.mesh.vertex_count() * 3);
    if (batch.wants_normals) result.normals.resize(result.positions.size());
    result.strains.resize(frames * basis_.strain.fibre_count());
    result.excess.resize(frames * basis_.residual.feature_count());
    result.coefficients.resize(frames * basis_.residual.coefficient_count());
    scratch_.fibre_positions.resize(frames * 3 * basis_.strain.vertices.size());
    scratch_.features.resize(frames * basis_.residual.feature_count());
    scratch_.coordinates.resize(frames * basis_.residual.coordinate_count());
    scratch_.kernels.resize(frames * basis_.residual.centre_count());

    StageTime strain, residual, modify, pose, output;
    for (std::size_t begin = 0; begin < frames; begin += kFramesAtOnce) {
      const FrameRange range{begin, std::min(frames, begin + kFramesAtOnce)};
      find_frames(batch, range, strain);
      parallel_for(*executor_, range.count(), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k) find_coefficients(batch, range, k, result, strain, residual);
      });
      over_parts(range.count(), vertex_count(), [&](std::size_t k, std::size_t first, std::size_t count) {
        pose_part(batch, range, k, first, count, result, residual, modify, pose);
      });
    }
    result.stage_seconds = {{"strain", strain.seconds()}, {"residual", residual.seconds()}, {"pose", pose.seconds()}};
    if (!basis_.modifiers.empty()) result.stage_seconds["modify"] = modify.seconds();
    if (batch.keeps_posed) result.posed = result.positions;
    if (!batch.jiggle.empty()) {
      dynamics_->run(batch, weights_.jiggle, result.strains, result.positions, result.stage_seconds);
    }
    for (std::size_t begin = 0; batch.wants_normals && begin < frames; begin += kFramesAtOnce) {
      find_normals({begin, std::min(frames, begin + kFramesAtOnce)}, frames, result, output);
    }
    result.stage_seconds["output"] = output.seconds();
    return result;
  }

 private:
  // Arrays of a batch that nobody asks for, kept from batch to batch.
  struct Scratch {
    std::vector<float> fibre_positions, features, coordinates, kernels;
    std::vector<float> areas;   // of kFramesAtOnce frames
    std::vector<float> frames;  // of all blocks of kFramesAtOnce frames; none without strains
  };

  // function(frame, first, count) of all parts of `elements` vertices or triangles in each of all frames.
  template <typename Function>
  void over_parts(std::size_t frames, std::size_t elements, const Function& function) const {
    const std::size_t parts = (elements + kPartVertices - 1) / kPartVertices;
    parallel_for(*executor_, frames * parts, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const std::size_t first = k % parts * kPartVertices;
        function(k / parts, first, std::min(kPartVertices, elements - first));
      }
    });
  }

  std::size_t vertex_count() const { return basis_.mesh.vertex_count(); }
  std::size_t block_count() const { return basis_.ddm.block_begin.size() - 1; }

  // Frames of Direct Delta Mush of the blocks of frame k of a range, from `first_block` on; none without strains.
  std::span<float> known_frames(std::size_t k, std::size_t first_block) {
    if (scratch_.frames.empty()) return {};
    return std::span(scratch_.frames)
        .subspan(cpu::kFrameNumbers * k * block_count(), cpu::kFrameNumbers * block_count())
        .subspan(cpu::kFrameNumbers * first_block);
  }

  // Strains and the pose stage both need them.
  void find_frames(const Batch& batch, FrameRange range, StageTime& strain) {
    if (basis_.strain.vertices.empty()) return;
    scratch_.frames.resize(std::max(scratch_.frames.size(), cpu::kFrameNumbers * range.count() * block_count()));
    over_parts(range.count(), vertex_count(), [&](std::size_t k, std::size_t first, std::size_t count) {
      auto last = std::chrono::steady_clock::now();
      const std::size_t block = first / kBlockSize, blocks = (count + kBlockSize - 1) / kBlockSize;
      cpu::block_frames(basis_.ddm, of_frame(batch.skinning, range.begin + k, batch.frame_count).data(),
                        static_cast<std::uint32_t>(block), known_frames(k, block).first(cpu::kFrameNumbers * blocks));
      strain.add_since(last);
    });
  }

  void find_coefficients(const Batch& batch, FrameRange range, std::size_t k, BatchResult& result, StageTime& strain,
                         StageTime& residual) {
    const ResidualTable& table = basis_.residual;
    const auto frame = [&](auto& values) { return of_frame(values, range.begin + k, batch.frame_count); };
    const auto fibre_positions = frame(scratch_.fibre_positions), features = frame(scratch_.features),
               coordinates = frame(scratch_.coordinates), kernels = frame(scratch_.kernels);
    auto last = std::chrono::steady_clock::now();
    cpu::place_strain_vertices(basis_.ddm, basis_.strain, known_frames(k, 0), fibre_positions);
    cpu::strain_measure(basis_.strain, fibre_positions, frame(result.strains));
    strain.add_since(last);
    cpu::residual_features(table.features, frame(batch.joint_features), frame(result.strains), frame(batch.controls), 1,
                           features, frame(result.excess));
    cpu::residual_project(table, features, 1, coordinates);
    if (weights_.kernels) {
      cpu::residual_kernels(table, coordinates, 1, kernels);
    } else {
      std::fill(kernels.begin(), kernels.end(), 0.0f);
    }
    cpu::residual_coefficients(table, coordinates, kernels, rest_coefficients_, frame(batch.fades), 1,
                               frame(result.coefficients));
    residual.add_since(last);
  }

  void pose_part(const Batch& batch, FrameRange range, std::size_t k, std::size_t first, std::size_t count,
                 BatchResult& result, StageTime& residual, StageTime& modify, StageTime& pose) {
    const std::size_t f = range.begin + k;
    const auto block = static_cast<std::uint32_t>(first / kBlockSize);
    float numbers[3 * kPartVertices];
    const std::span<float> displacements(numbers, 3 * count);
    auto last = std::chrono::steady_clock::now();
    cpu::blend_blocks(basis_.residual, of_frame(result.coefficients, f, batch.frame_count).data(), weights_.correction,
                      block, displacements);
    residual.add_since(last);
    if (!basis_.modifiers.empty()) {
      cpu::modify_blocks(basis_.modifiers, of_frame(batch.modifiers, f, batch.frame_count).data(), block,
                         displacements);
      modify.add_since(last);
    }
    cpu::pose_blocks(basis_.ddm, of_frame(batch.skinning, f, batch.frame_count).data(), known_frames(k, block).data(),
                     &batch.origins[4 * f], block, displacements,
                     of_frame(result.positions, f, batch.frame_count).subspan(3 * first, 3 * count));
    pose.add_since(last);
  }

  void find_normals(FrameRange range, std::size_t frames, BatchResult& result, StageTime& output) {
    const std::size_t triangles = basis_.mesh.triangles.size() / 3, numbers = cpu::kAreaNumbers * triangles;
    scratch_.areas.resize(std::max(scratch_.areas.size(), numbers * range.count()));
    const std::span<float> areas(scratch_.areas);
    over_parts(range.count(), triangles, [&](std::size_t k, std::size_t first, std::size_t count) {
      auto last = std::chrono::steady_clock::now();
      cpu::area_vectors(basis_.mesh, of_frame(result.positions, range.begin + k, frames), first,
                        areas.subspan(k * numbers + cpu::kAreaNumbers * first, cpu::kAreaNumbers * count));
      output.add_since(last);
    });
    over_parts(range.count(), vertex_count(), [&](std::size_t k, std::size_t first, std::size_t count) {
      auto last = std::chrono::steady_clock::now();
      cpu::part_normals(basis_.mesh, areas.subspan(k * numbers, numbers), first,
                        of_frame(result.normals, range.begin + k, frames).subspan(3 * first, 3 * count));
      output.add_since(last);
    });
  }

  const Basis& basis_;
  const std::shared_ptr<Executor> executor_;
  std::vector<float> rest_coefficients_;
  Weights weights_;
  std::optional<CpuDynamics> dynamics_;
  Scratch scratch_;
};

}  // namespace

std::unique_ptr<Backend> make_cpu_backend(const Basis& basis, const JiggleModel& jiggle,
                                          std::shared_ptr<Executor> executor) {
  return std::make_unique<CpuBackend>(basis, jiggle, std::move(executor));
}

}  // namespace bodyopt
