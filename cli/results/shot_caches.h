// The caches that `eval` writes of a shot, and what there is to say of its frames.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cli/results/attachments.h"
#include "cli/results/evaluation_log.h"
#include "farm/task_run.h"
#include "runtime/basis/levels.h"
#include "runtime/core/executor.h"

namespace bodyopt::cli {

// Of which character, where to, in which form.
struct ShotCacheOptions {
  std::string basis, out, attached;
  std::size_t level = 0;
  bool full_skin = false;
  CacheSpace space{};
};

// What a run is made of before its first frame. With dynamics, the deformer jiggles.
struct EvaluatedShot {
  std::unique_ptr<Deformer> deformer;
  CarriedSkin carried;
  Clip clip;
  std::vector<int> frames;
  std::vector<Pose> poses;
};

// Skin and attached meshes, frame by frame. Options and shot must outlive it.
class ShotCaches {
 public:
  ShotCaches(const ShotCacheOptions& options, EvaluatedShot& shot);

  // Frames begin, begin + 1, ...
  void append(const Evaluation& part, std::size_t begin);
  void close();

  // Leaves a checkpoint after so many frames.
  void put_aside(const TaskRun& task, std::size_t frames);
  // Goes on from a checkpoint, where there is one, and returns how many frames it holds.
  std::size_t take_up(const TaskRun& task);

  std::uint32_t points() const { return points_; }
  const EvaluationLog& log() const { return log_; }
  Json attached() const { return attached_.written(); }
  const std::vector<std::string>& attached_paths() const { return attached_.paths(); }

 private:
  const ShotCacheOptions& options_;
  EvaluatedShot& shot_;
  AttachedCaches attached_;
  std::unique_ptr<CacheWriter> skin_;
  std::uint32_t points_ = 0;
  EvaluationLog log_;
  std::unique_ptr<Executor> threads_;
};

}  // namespace bodyopt::cli
