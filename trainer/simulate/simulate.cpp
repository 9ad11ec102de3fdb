#include "trainer/simulate/simulate.h"

#include <xxhash.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

#include "runtime/basis/error.h"
#include "trainer/dataset/pc2.h"
#include "trainer/progress.h"
#include "trainer/simulate/body_simulator.h"
#include "trainer/simulate/frame_journal.h"

namespace bodyopt {
namespace {

constexpr double kConverged = 1e-4;

// Everything the shapes depend on, so that a journal is only continued by the run that began it.
class InputsHash {
 public:
  InputsHash() : state_(XXH3_createState()) { XXH3_64bits_reset(state_); }
  ~InputsHash() { XXH3_freeState(state_); }
  InputsHash(const InputsHash&) = delete;
  InputsHash& operator=(const InputsHash&) = delete;

  void add(const void* bytes, std::size_t size) { XXH3_64bits_update(state_, bytes, size); }
  void add(double value) { add(&value, sizeof(value)); }
  std::uint64_t value() const { return XXH3_64bits_digest(state_); }

 private:
  XXH3_state_t* state_;
};

std::uint64_t hash_inputs(const BodySimulator& simulator, const Character& character,
                          const std::vector<Muscle>& muscles, const Clip& clip, const std::vector<int>& frames) {
  InputsHash hash;
  const TetMesh& mesh = simulator.mesh();
  hash.add(mesh.nodes.data(), sizeof(double) * static_cast<std::size_t>(mesh.nodes.size()));
  hash.add(mesh.tets.data(), sizeof(int) * static_cast<std::size_t>(mesh.tets.size()));
  hash.add(character.output_vertex.data(), sizeof(std::uint32_t) * character.output_vertex.size());
  for (const auto& row : character.weights) {
    for (const JointWeight& w : row) {
      hash.add(w.joint);
      hash.add(w.weight);
    }
  }
  for (const Joint& joint : character.skeleton.joints) hash.add(&joint.inverse_bind, sizeof(joint.inverse_bind));
  for (const Muscle& muscle : muscles) {
    hash.add(muscle.radius);
    hash.add(muscle.max_activation);
    for (const MusclePoint& point : muscle.path) {
      hash.add(point.joint);
      hash.add(point.position.data(), sizeof(point.position));
    }
  }
  for (const int frame : frames) {
    hash.add(frame);
    for (const JointTransform& t : clip.poses[static_cast<std::size_t>(frame - clip.first_frame)].joints) {
      hash.add(&t, sizeof(t));
    }
  }
  return hash.value();
}

// Solves the frames that the journal does not have, several at once. The first failure stops all and is thrown.
class FrameRunner {
 public:
  FrameRunner(const Character& character, const BodySimulator& simulator, const Clip& clip, FrameJournal& journal,
              Progress& progress)
      : character_(character), simulator_(simulator), clip_(clip), journal_(journal), progress_(progress) {}

  void run(const std::vector<int>& frames, int threads) {
    std::vector<std::thread> workers;
    for (int k = 0; k < threads; ++k) {
      workers.emplace_back([&] { work(frames); });
    }
    for (std::thread& worker : workers) worker.join();
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  void work(const std::vector<int>& frames) {
    try {
      for (std::size_t k = next_++; k < frames.size() && !stop_; k = next_++) {
        const FrameStatus status = solve(frames[k]);
        const std::lock_guard lock(mutex_);
        journal_.append(status, shape_of_thread());
        progress_.advance();
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
      stop_ = true;
    }
  }

  static std::vector<float>& shape_of_thread() {
    thread_local std::vector<float> shape;
    return shape;
  }

  FrameStatus solve(int frame) const {
    const auto start = std::chrono::steady_clock::now();
    const SimulatedShape shape = simulator_.simulate(clip_.poses[static_cast<std::size_t>(frame - clip_.first_frame)]);
    shape_of_thread() = output_from_welded(character_, shape.nodes.topRows(character_.vertices.rows()));
    FrameStatus status;
    status.frame = frame;
    status.residual = shape.solve.residual;
    status.iterations = shape.solve.iterations;
    status.inverted_tets = shape.solve.inverted;
    status.converged = !shape.stalled && shape.solve.inverted == 0 && shape.solve.residual < kConverged;
    status.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return status;
  }

  const Character& character_;
  const BodySimulator& simulator_;
  const Clip& clip_;
  FrameJournal& journal_;
  Progress& progress_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::exception_ptr failure_;
};

}  // namespace

std::vector<FrameStatus> simulate(const Character& character, const std::vector<Muscle>& muscles, const Clip& clip,
                                  const std::vector<int>& frames, const std::filesystem::path& cache,
                                  const std::filesystem::path& status, const SimulateOptions& options) {
  const BodySimulator simulator(character, muscles, options.tet_size);
  FrameJournal journal(cache.string() + ".partial", hash_inputs(simulator, character, muscles, clip, frames),
                       3 * std::size_t{character.output_count()});
  std::vector<int> open;
  for (const int frame : frames) {
    if (!journal.has(frame)) open.push_back(frame);
  }
  {
    Progress progress("simulate", frames.size());
    progress.advance(frames.size() - open.size());
    const int threads = options.threads > 0 ? options.threads : static_cast<int>(std::thread::hardware_concurrency());
    FrameRunner(character, simulator, clip, journal, progress).run(open, std::max(1, threads));
  }

  std::vector<FrameStatus> result;
  Pc2Writer writer(cache, character.output_count(), static_cast<std::uint32_t>(frames.size()),
                   frames.empty() ? 1.0f : static_cast<float>(frames.front()));
  for (const int frame : frames) {
    writer.append(journal.shape(frame));
    result.push_back(journal.status(frame));
  }
  write_frame_status(result, status);
  writer.close();
  journal.remove();
  return result;
}

}  // namespace bodyopt
