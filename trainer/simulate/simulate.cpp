#include "trainer/simulate/simulate.h"

#include <atomic>
#include <exception>
#include <mutex>
#include <set>
#include <thread>

#include "runtime/basis/error.h"
#include "trainer/dataset/pc2.h"
#include "trainer/progress.h"
#include "trainer/simulate/body_hash.h"
#include "trainer/simulate/partial_shapes.h"
#include "trainer/simulate/quasi_static.h"

namespace bodyopt {
namespace {

const Pose& pose_of(const Clip& clip, int frame) {
  if (frame < clip.first_frame || frame > clip.last_frame()) {
    throw Error(ErrorKind::usage, "frame " + std::to_string(frame) + " is not in clip '" + clip.name +
                                      "', whose frames are " + std::to_string(clip.first_frame) + "-" +
                                      std::to_string(clip.last_frame()));
  }
  return clip.poses[static_cast<std::size_t>(frame - clip.first_frame)];
}

void require_distinct(const std::vector<int>& frames) {
  if (frames.empty()) throw Error(ErrorKind::usage, "there are no frames to simulate");
  std::set<int> seen;
  for (const int frame : frames) {
    if (!seen.insert(frame).second) {
      throw Error(ErrorKind::usage, "frame " + std::to_string(frame) + " is to be simulated twice");
    }
  }
}

// A frame to solve; frames of the same key have the same shape.
struct Job {
  std::uint64_t key;
  const Pose* pose;
};

std::vector<Job> jobs_of(const QuasiStaticBody& body, const Clip& clip, const std::vector<int>& frames) {
  std::vector<Job> jobs;
  for (const int frame : frames) {
    const Pose& pose = pose_of(clip, frame);
    jobs.push_back({pose_hash(body.hash(), pose), &pose});
  }
  return jobs;
}

// Takes the shapes of the jobs over from a finished cache.
void adopt_finished(const std::filesystem::path& cache, const std::filesystem::path& status, const Character& character,
                    const std::vector<Job>& jobs, PartialShapes& partial) {
  if (!std::filesystem::exists(cache) || !std::filesystem::exists(status)) return;
  const Pc2Reader shapes(cache);
  const std::vector<FrameStatus> finished = read_frame_status(status);
  if (shapes.sample_count() != finished.size() || shapes.point_count() != character.output_count()) return;
  std::set<std::uint64_t> wanted;
  for (const Job& job : jobs) wanted.insert(job.key);
  for (std::size_t k = 0; k < finished.size(); ++k) {
    const std::uint64_t key = finished[k].inputs;
    if (!wanted.contains(key) || partial.has(key)) continue;
    partial.append(key, finished[k], shapes.sample(static_cast<std::uint32_t>(k)));
  }
}

// Jobs not solved yet, each once.
std::vector<Job> open_jobs(const std::vector<Job>& jobs, const PartialShapes& partial) {
  std::vector<Job> open;
  std::set<std::uint64_t> seen;
  for (const Job& job : jobs) {
    if (!partial.has(job.key) && seen.insert(job.key).second) open.push_back(job);
  }
  return open;
}

std::vector<float> output_shape(const Character& character, const Positions& nodes) {
  return output_from_welded(character, nodes.topRows(character.vertices.rows()));
}

// Solves the jobs on some threads. A pose is solved by one thread alone, so their number changes no bit.
void solve_all(const QuasiStaticBody& body, const Character& character, const std::vector<Job>& jobs, int threads,
               PartialShapes& partial) {
  Progress progress("simulate", jobs.size());
  std::atomic<std::size_t> next{0};
  std::mutex mutex;  // over partial, progress and failure
  std::exception_ptr failure;
  const auto work = [&] {
    try {
      for (std::size_t k = next++; k < jobs.size(); k = next++) {
        const SolvedPose solved = body.solve(*jobs[k].pose);
        const std::vector<float> shape = output_shape(character, solved.nodes);
        const std::lock_guard<std::mutex> lock(mutex);
        partial.append(jobs[k].key, solved.status, shape);
        progress.advance();
      }
    } catch (...) {
      next = jobs.size();
      const std::lock_guard<std::mutex> lock(mutex);
      if (!failure) failure = std::current_exception();
    }
  };
  const auto wanted = threads > 0 ? static_cast<std::size_t>(threads)
                                  : static_cast<std::size_t>(std::max(std::thread::hardware_concurrency(), 1u));
  std::vector<std::jthread> pool;
  while (pool.size() + 1 < std::min(wanted, jobs.size())) pool.emplace_back(work);
  work();
  pool.clear();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace

std::vector<FrameStatus> simulate(const Character& character, const std::vector<Muscle>& muscles, const Clip& clip,
                                  const std::vector<int>& frames, const std::filesystem::path& cache,
                                  const std::filesystem::path& status, const SimulateOptions& options) {
  require_distinct(frames);
  const QuasiStaticBody body(character, muscles, options.tet_size);
  std::filesystem::path partial_path = cache;
  partial_path += ".partial";
  PartialShapes partial(partial_path, body.hash(), 3 * static_cast<std::size_t>(character.output_count()));
  const std::vector<Job> jobs = jobs_of(body, clip, frames);
  adopt_finished(cache, status, character, jobs, partial);
  solve_all(body, character, open_jobs(jobs, partial), options.threads, partial);

  std::vector<FrameStatus> result;
  Pc2Writer writer(cache, character.output_count(), static_cast<std::uint32_t>(frames.size()),
                   static_cast<float>(frames.front()));
  for (std::size_t k = 0; k < frames.size(); ++k) {
    FrameStatus& of_frame = result.emplace_back();
    writer.append(partial.read(jobs[k].key, of_frame));
    of_frame.frame = frames[k];
    of_frame.converged = is_converged(of_frame);
    of_frame.inputs = jobs[k].key;
  }
  // Killed in between, the side-car and the cache do not match: but the unfinished file still has every frame.
  write_frame_status(result, status);
  writer.close();
  partial.remove();
  return result;
}

}  // namespace bodyopt
