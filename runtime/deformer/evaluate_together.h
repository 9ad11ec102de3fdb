// Calls of several deformers at once.
#pragma once

#include <exception>
#include <optional>
#include <span>
#include <vector>

#include "runtime/basis/skeleton.h"
#include "runtime/deformer/evaluation.h"
#include "runtime/host/backend.h"
#include "runtime/host/rig.h"

namespace bodyopt {

class Deformer;

struct Basis;

// What a deformer is to evaluate, and where the skin goes: into the Evaluation unless it stays on the device or has a
// place.
struct DeformerCall {
  Deformer* deformer = nullptr;
  std::span<const Pose> poses;
  Evaluation* evaluation = nullptr;              // that is written, into the memory of what it held
  std::optional<std::span<const int>> frames{};  // a number of each pose: the skin jiggles; none: it is quasi-static
  // On a device of others: positions and normals stay there, with the same bits, and are none of the result. One batch:
  // Error(usage) for more than batch_limit() poses.
  bool stays_on_device = false;
  // Where positions, normals and tangents are written, which are then none of the result. Error(usage) for tangents of
  // a model without texture coordinates.
  const SkinPlace* place = nullptr;
  std::exception_ptr error{};  // what became of it; null: it went well
};

// Every call has the bits that it has alone. What all of them have for one device goes there in one
// submission, and is waited for once; calls of more than one batch go on in further ones. One that fails takes none of
// the others with it, unless their device is lost; its error is that of Deformer::evaluate or Deformer::jiggle. Throws
// Error(usage) where a deformer is called twice.
void evaluate_together(std::span<DeformerCall> calls);

// What a deformer keeps from call to call, so that no frame but the first allocates.
struct CallMemory {
  explicit CallMemory(const Skeleton& skeleton) : rig(skeleton) {}

  Rig rig;
  RigFrame frame;
  std::vector<double> off, taken;  // of the fade
  Batch batch;
  JiggleState before;  // the call
};

// In `memory`, which is of the basis' skeleton. Throws Error(mismatch) when a pose does not fit the skeleton, or holds
// a number that is not finite.
Batch& make_batch(const Basis& basis, std::span<const Pose> poses, CallMemory& memory);

}  // namespace bodyopt
