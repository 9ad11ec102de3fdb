// Calls of several deformers at once.
#pragma once

#include <array>
#include <cstddef>
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

// A deformer's poses to evaluate, and where the skin goes: into the Evaluation unless it stays on the device or has a
// place.
struct DeformerCall {
  Deformer* deformer = nullptr;
  std::span<const Pose> poses;
  Evaluation* evaluation = nullptr;              // that is written, into the memory of what it held
  std::optional<std::span<const int>> frames{};  // a number of each pose: the skin jiggles; none: it is quasi-static
  // Positions and normals stay on a device that others use, with the same bits, and are none of the result. There is
  // one batch: Error(usage) for more than largest_batch() poses.
  bool stays_on_device = false;
  // There is one batch, too: all of its skin is on the device after the call, beside what goes to the host.
  bool is_one_batch = false;
  // Positions, normals and tangents are written here, and are then none of the result. Error(usage) for tangents of a
  // model without texture coordinates.
  const SkinPlace* place = nullptr;
  std::exception_ptr error{};  // what became of it; null: it went well
};

// Every call has the bits that it has alone. All work for one device is one submission and one wait; calls of more than
// one batch go on in further ones, and a device runs a batch while the host prepares the next and takes the one before.
// A call that fails does not fail the others, unless their device is lost. Its error is that of Deformer::evaluate or
// Deformer::jiggle. Throws Error(usage) where a deformer is called twice.
void evaluate_together(std::span<DeformerCall> calls);

// Memory that a deformer keeps from call to call, so that no frame but the first allocates.
struct CallMemory {
  explicit CallMemory(const Skeleton& skeleton) : rig(skeleton) {}

  Rig rig;
  RigFrame frame;
  std::vector<double> off, taken;  // of the fade
  std::array<Batch, 2> batches;    // the second while the first is under way
  JiggleState before;              // the call
};

// Makes a batch in `memory`, which is of the basis' skeleton; `which`: of its two. Throws Error(mismatch) when a pose
// does not fit the skeleton, or holds a number that is not finite.
Batch& make_batch(const Basis& basis, std::span<const Pose> poses, CallMemory& memory, std::size_t which = 0);

}  // namespace bodyopt
