// The CPU as a backend: the kernels of runtime/cpu one after the other, frames and blocks in parallel.
#include "runtime/cpu/cpu_backend.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <utility>

#include "runtime/cpu/cpu_dynamics.h"
#include "runtime/cpu/ddm_frames.h"
#include "runtime/cpu/kernels.h"
#include "runtime/cpu/parallel.h"
#include "runtime/host/output_steps.h"
#include "runtime/host/stages.h"

namespace bodyopt {
namespace {

using cpu::of_frame;

// Vertices of a frame that are posed, or get their normals, at a time (and triangles, their area vectors). Their
// displacements stay in the nearest cache.
constexpr std::size_t kPartBlocks = 32, kPartVertices = kPartBlocks * kBlockSize;

// Frames of a batch, and the bytes of their skins and normals at most: these, and what is known of their blocks, stay
// in the caches between the stages. Of a body of more than 40,000 vertices a batch is one frame.
constexpr std::size_t kMostFrames = 8, kMostSkinBytes = std::size_t{2} << 20;

// Seconds of the stages, summed over threads.
class StageTimes {
 public:
  using Clock = std::chrono::steady_clock;

  void add_since(Clock::time_point& last, Stage stage) {
    const Clock::time_point now = Clock::now();
    seconds_[index_of(stage)].fetch_add(std::chrono::duration<double>(now - last).count(), std::memory_order_relaxed);
    last = now;
  }
  double of(Stage stage) const { return seconds_[index_of(stage)]; }

 private:
  PerStage<std::atomic<double>> seconds_{};
};

// A batch under way.
struct Work {
  const Batch& batch;
  BatchResult& result;
  StageTimes times{};
};

class CpuBackend final : public Backend {
 public:
  CpuBackend(std::shared_ptr<const CharacterModel> model, const JiggleModel& jiggle, std::shared_ptr<Executor> executor)
      : model_(std::move(model)),
        basis_(model_->basis),
        executor_(executor ? std::move(executor) : std::make_shared<SerialExecutor>()),
        rest_coefficients_(basis_.residual.coefficient_count(), 0) {
    if (jiggle.dynamics) dynamics_.emplace(jiggle, *executor_);
  }

  std::string name() const override { return "cpu"; }
  Executor& threads() const override { return *executor_; }
  std::uint32_t batch_limit() const override {
    const std::size_t frame = 6 * sizeof(float) * std::max<std::size_t>(1, vertex_count());
    return static_cast<std::uint32_t>(std::clamp<std::size_t>(kMostSkinBytes / frame, 1, kMostFrames));
  }
  void set_rest_coefficients(std::span<const float> c) override { rest_coefficients_.assign(c.begin(), c.end()); }
  void set_weights(const Weights& weights) override { weights_ = weights; }
  void set_motion(const NodeMotion& motion) override { dynamics_->motion = motion; }
  NodeMotion motion() const override { return dynamics_->motion; }

  const BatchResult& run(const Batch& batch) override {
    Work work{batch, result_};
    prepare(batch, work.result);
    stages_ = stages_of(basis_, batch, std::move(stages_));
    for (const Stage stage : stages_) run_frames(stage, work);
    run_parts(stages_, work);
    for (const Stage stage : stages_) run_batch(stage, work);
    for (const Stage stage : stages_) work.result.stage_seconds.add(stage, work.times.of(stage));
    return result_;
  }

 private:
  // Runs what a stage does before any of the skin is posed.
  void run_frames(Stage stage, Work& work) {
    if (stage == Stage::strain) find_strains(work);
    if (stage == Stage::residual) find_coefficients(work);
  }

  // Runs what a stage does once the whole batch is posed.
  void run_batch(Stage stage, Work& work) {
    auto last = StageTimes::Clock::now();
    BatchResult& result = work.result;
    if (stage == Stage::pose && work.batch.keeps_posed) result.posed = result.positions;
    if (stage == Stage::diffuse) dynamics_->diffuse(work.batch, result.positions);
    if (stage == Stage::jiggle) dynamics_->jiggle(work.batch, weights_.jiggle, result.strains, result.positions);
    if (stage == Stage::output) {
      finish(work);
      if (work.batch.wants_normals || work.batch.wants_tangents) find_normals(work);
      if (work.batch.wants_tangents) find_tangents(work);
      return;
    }
    work.times.add_since(last, stage);
  }

  // Arrays of a batch that nobody asks for, kept from batch to batch.
  struct Scratch {
    std::vector<float> fibre_positions, features, kernels;
    std::vector<float> finished, unfinished;  // skins by modifiers that move it in the end
    std::vector<float> boxes, areas;
    std::vector<cpu::BentFolds> bent_folds;
    std::vector<float> frames;  // of all blocks; none without strains
  };

  void prepare(const Batch& batch, BatchResult& result) {
    const std::size_t frames = batch.frame_count;
    result.positions.resize(frames * vertex_count() * 3);
    result.normals.resize(batch.wants_normals || batch.wants_tangents ? result.positions.size() : 0);
    result.tangents.resize(batch.wants_tangents ? frames * basis_.mesh.output_count() * 4 : 0);
    result.posed.clear();
    result.stage_seconds = {};
    result.strains.resize(frames * basis_.strain.fibre_count());
    result.excess.resize(frames * basis_.residual.feature_count());
    result.coordinates.resize(frames * basis_.residual.coordinate_count());
    result.coefficients.resize(frames * basis_.residual.coefficient_count());
    scratch_.fibre_positions.resize(frames * 3 * basis_.strain.vertices.size());
    scratch_.features.resize(frames * basis_.residual.feature_count());
    scratch_.kernels.resize(frames * basis_.residual.centre_count());
  }

  // function(f) of all frames, as work of a stage.
  template <typename Function>
  void over_frames(Work& work, Stage stage, const Function& function) const {
    parallel_each(*executor_, work.batch.frame_count, 1, [&](std::size_t f) {
      auto last = StageTimes::Clock::now();
      function(f);
      work.times.add_since(last, stage);
    });
  }

  // function(f, first, count) of all parts of `elements` vertices or triangles in each of all frames, the same.
  template <typename Function>
  void over_parts(Work& work, Stage stage, std::size_t elements, const Function& function) const {
    parallel_pieces(*executor_, work.batch.frame_count, elements, kPartVertices,
                    [&](std::size_t frame, std::size_t first, std::size_t count) {
                      auto last = StageTimes::Clock::now();
                      function(frame, first, count);
                      work.times.add_since(last, stage);
                    });
  }

  std::size_t vertex_count() const { return basis_.mesh.vertex_count(); }
  std::size_t block_count() const { return basis_.ddm.block_begin.size() - 1; }

  // The skinning that strains are measured on.
  static const std::vector<float>& learned_skinning(const Batch& batch) {
    return batch.learned_skinning.empty() ? batch.skinning : batch.learned_skinning;
  }

  // Are the frames of the strains those that the skin is posed by?
  static bool poses_as_learned(const Batch& batch, std::size_t f) {
    return std::ranges::equal(of_frame(batch.skinning, f, batch.frame_count),
                              of_frame(learned_skinning(batch), f, batch.frame_count));
  }

  // Frames of Direct Delta Mush of the blocks of frame f, from `first_block` on; none without strains.
  std::span<float> known_frames(std::size_t f, std::size_t first_block) {
    if (scratch_.frames.empty()) return {};
    return std::span(scratch_.frames)
        .subspan(cpu::kFrameNumbers * f * block_count(), cpu::kFrameNumbers * block_count())
        .subspan(cpu::kFrameNumbers * first_block);
  }

  // Finds the frames of Direct Delta Mush of all blocks, and from them the strains. The pose stage uses the frames
  // again, where no modifier turned a joint.
  void find_strains(Work& work) {
    if (basis_.strain.vertices.empty()) return;
    const Batch& batch = work.batch;
    scratch_.frames.resize(std::max(scratch_.frames.size(), cpu::kFrameNumbers * batch.frame_count * block_count()));
    over_parts(work, Stage::strain, vertex_count(), [&](std::size_t f, std::size_t first, std::size_t count) {
      const std::size_t block = first / kBlockSize, blocks = (count + kBlockSize - 1) / kBlockSize;
      cpu::block_frames(basis_.ddm, of_frame(learned_skinning(batch), f, batch.frame_count).data(),
                        static_cast<std::uint32_t>(block), known_frames(f, block).first(cpu::kFrameNumbers * blocks));
    });
    over_frames(work, Stage::strain, [&](std::size_t f) {
      const auto positions = of_frame(scratch_.fibre_positions, f, batch.frame_count);
      cpu::place_strain_vertices(basis_.ddm, basis_.strain, known_frames(f, 0), positions);
      cpu::strain_measure(basis_.strain, positions, of_frame(work.result.strains, f, batch.frame_count));
    });
  }

  void find_coefficients(Work& work) {
    const Batch& batch = work.batch;
    over_frames(work, Stage::residual, [&](std::size_t f) {
      const auto frame = [&](auto& values) { return of_frame(values, f, batch.frame_count); };
      cpu::residual_features(basis_.residual.features, frame(batch.joint_features), frame(work.result.strains),
                             frame(batch.controls), 1, frame(scratch_.features), frame(work.result.excess));
    });
    const std::size_t regions = basis_.residual.regions.size();
    parallel_parts(*executor_, batch.frame_count * regions, 1, [&](std::size_t begin, std::size_t end) {
      auto last = StageTimes::Clock::now();
      for (std::size_t k = begin; k < end; ++k) find_coefficients(work, k / regions, k % regions);
      work.times.add_since(last, Stage::residual);
    });
  }

  // Finds the coefficients of frame f and a region.
  void find_coefficients(Work& work, std::size_t f, std::size_t region) {
    const ResidualTable& table = basis_.residual;
    const auto frame = [&](auto& values) { return of_frame(values, f, work.batch.frame_count).data(); };
    const std::span<float> kernels = of_frame(scratch_.kernels, f, work.batch.frame_count);
    float* const coordinates = frame(work.result.coordinates);
    cpu::region_coordinates(table, region, frame(scratch_.features), coordinates);
    if (weights_.kernels) {
      cpu::region_kernels(table, region, coordinates, kernels.data());
    } else {
      const Region& own = table.regions[region];
      std::ranges::fill(kernels.subspan(own.centre_begin, own.centre_count), 0.0f);
    }
    cpu::region_coefficients(table, region, coordinates, kernels.data(), rest_coefficients_,
                             frame(work.batch.fades)[region], frame(work.result.coefficients));
  }

  // Runs stages part by part, one after the other while a part is in the nearest cache.
  void run_parts(std::span<const Stage> stages, Work& work) {
    parallel_pieces(
        *executor_, work.batch.frame_count, vertex_count(), kPartVertices,
        [&](std::size_t f, std::size_t first, std::size_t count) {
          const auto frame = [&](auto& values) { return of_frame(values, f, work.batch.frame_count); };
          const auto block = static_cast<std::uint32_t>(first / kBlockSize);
          float numbers[3 * kPartVertices];
          const std::span<float> displacements(numbers, 3 * count);
          const std::span<float> known = poses_as_learned(work.batch, f) ? known_frames(f, block) : std::span<float>();
          auto last = StageTimes::Clock::now();
          for (const Stage stage : stages) {
            if (stage == Stage::residual) {
              cpu::blend_blocks(basis_.residual, frame(work.result.coefficients).data(), weights_.correction, block,
                                displacements);
            } else if (stage == Stage::modify) {
              cpu::modify_blocks(basis_.modifiers, frame(work.batch.modifiers).data(), block, displacements);
            } else if (stage == Stage::pose) {
              cpu::pose_blocks(basis_.ddm, frame(work.batch.skinning).data(), known.data(), &work.batch.origins[4 * f],
                               block, displacements, frame(work.result.positions).subspan(3 * first, 3 * count));
            }
            work.times.add_since(last, stage);
          }
        });
  }

  // Applies the modifiers that move the posed skin in the end.
  void finish(Work& work) {
    std::vector<float>& positions = work.result.positions;
    bool separates = true;
    output_steps_ = output_steps(basis_, work.batch, std::move(output_steps_));
    for (const OutputStep& step : output_steps_) {
      scratch_.finished.resize(positions.size());
      switch (step.kind) {
        case PosedSkinStep::relax:
          relax(work, step);
          break;
        case PosedSkinStep::separate:
          if (step.number == 0) scratch_.unfinished = positions;
          if (step.number > 0 && !separates) continue;  // nothing has moved that could move on
          separates = separate(work, step);
          break;
      }
      positions.swap(scratch_.finished);
    }
  }

  void relax(Work& work, const OutputStep& step) {
    const std::size_t frames = work.batch.frame_count;
    over_parts(work, Stage::output, vertex_count(), [&](std::size_t f, std::size_t first, std::size_t count) {
      cpu::relax_part(basis_.mesh, of_frame(work.batch.modifiers, f, frames)[step.modifier->first_component],
                      of_frame(work.result.positions, f, frames), first,
                      of_frame(scratch_.finished, f, frames).subspan(3 * first, 3 * count));
    });
  }

  // Returns whether anything moved.
  bool separate(Work& work, const OutputStep& step) {
    const OutputSeparatePush push = separate_push(basis_, step);
    std::atomic<bool> moves = false;
    find_bent_folds(work, push);
    over_parts(work, Stage::output, vertex_count(), [&](std::size_t f, std::size_t first, std::size_t count) {
      const auto frame = [&](auto& values) { return of_frame(values, f, work.batch.frame_count); };
      if (cpu::separate_part(basis_.mesh, model_->folds, push, scratch_.bent_folds[f].all(),
                             {frame(scratch_.unfinished), frame(work.result.positions)}, first,
                             frame(scratch_.finished).subspan(3 * first, 3 * count))) {
        moves = true;
      }
    });
    return moves;
  }

  void find_bent_folds(Work& work, const OutputSeparatePush& push) {
    const OutputBoundPush bound = bound_push(basis_);
    const std::size_t frames = work.batch.frame_count, numbers = std::size_t{6} * bound.box_count;
    scratch_.boxes.resize(frames * numbers);
    scratch_.bent_folds.resize(std::max(scratch_.bent_folds.size(), frames));
    over_frames(work, Stage::output, [&](std::size_t f) {
      const std::span<float> boxes = std::span(scratch_.boxes).subspan(f * numbers, numbers);
      cpu::output_bound(model_->folds.triangles, bound, of_frame(work.result.positions, f, frames), boxes);
      scratch_.bent_folds[f].find(push, of_frame(work.batch.modifiers, f, frames), boxes);
    });
  }

  void find_normals(Work& work) {
    const std::size_t frames = work.batch.frame_count;
    const std::size_t triangles = basis_.mesh.triangles.size() / 3, numbers = cpu::kAreaNumbers * triangles;
    scratch_.areas.resize(std::max(scratch_.areas.size(), frames * numbers));
    const std::span<float> areas(scratch_.areas);
    over_parts(work, Stage::output, triangles, [&](std::size_t f, std::size_t first, std::size_t count) {
      cpu::area_vectors(model_->near.triangles, of_frame(work.result.positions, f, frames), first,
                        areas.subspan(f * numbers + cpu::kAreaNumbers * first, cpu::kAreaNumbers * count));
    });
    over_parts(work, Stage::output, vertex_count(), [&](std::size_t f, std::size_t first, std::size_t count) {
      cpu::part_normals(basis_.mesh, model_->near.vertex_triangles, areas.subspan(f * numbers, numbers), first,
                        of_frame(work.result.normals, f, frames).subspan(3 * first, 3 * count));
    });
  }

  void find_tangents(Work& work) {
    const std::size_t frames = work.batch.frame_count;
    over_parts(work, Stage::output, basis_.mesh.output_count(),
               [&](std::size_t f, std::size_t first, std::size_t count) {
                 cpu::output_tangents(model_->tangents, of_frame(work.result.positions, f, frames),
                                      of_frame(work.result.normals, f, frames), first,
                                      of_frame(work.result.tangents, f, frames).subspan(4 * first, 4 * count));
               });
  }

  const std::shared_ptr<const CharacterModel> model_;
  const Basis& basis_;
  const std::shared_ptr<Executor> executor_;
  std::vector<float> rest_coefficients_;
  Weights weights_;
  std::optional<CpuDynamics> dynamics_;
  std::vector<Stage> stages_;             // of the batch
  std::vector<OutputStep> output_steps_;  // likewise
  BatchResult result_;
  Scratch scratch_;
};

}  // namespace

std::unique_ptr<Backend> make_cpu_backend(std::shared_ptr<const CharacterModel> model, const JiggleModel& jiggle,
                                          std::shared_ptr<Executor> executor) {
  return std::make_unique<CpuBackend>(std::move(model), jiggle, std::move(executor));
}

}  // namespace bodyopt
