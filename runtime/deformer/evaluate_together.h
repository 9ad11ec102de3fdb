// Calls of several deformers at once.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "runtime/basis/skeleton.h"
#include "runtime/deformer/evaluation.h"
#include "runtime/host/backend.h"

namespace bodyopt {

class Deformer;

// What a deformer is to evaluate, and where the skin goes: into the Evaluation unless one of the last two is given.
struct DeformerCall {
  Deformer* deformer = nullptr;
  std::span<const Pose> poses;
  std::optional<std::span<const int>> frames{};  // a number of each pose: the skin jiggles; none: it is quasi-static
  // On a device of others: positions and normals stay there, with the same bits, and are none of the result. One batch:
  // Error(usage) for more than batch_limit() poses.
  bool stays_on_device = false;
  // Where positions, normals and tangents are written, which are then none of the result. Error(usage) for tangents of
  // a model without texture coordinates.
  const SkinPlace* place = nullptr;
};

struct CallOutcome {
  Evaluation evaluation;
  std::exception_ptr error;  // null: it went well
};

// The outcome of every call, with the bits that it has alone. What all of them have for one device goes there in one
// submission, and is waited for once; calls of more than one batch go on in further ones. One that fails takes none of
// the others with it, unless their device is lost; its error is that of Deformer::evaluate or Deformer::jiggle. Throws
// Error(usage) where a deformer is called twice.
std::vector<CallOutcome> evaluate_together(std::span<const DeformerCall> calls);

struct Pose;

// Throws Error(mismatch) when a pose does not fit the skeleton, or holds a number that is not finite.
Batch make_batch(const Basis& basis, std::span<const Pose> poses);

}  // namespace bodyopt
