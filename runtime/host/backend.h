// A backend runs the stages of a batch: the CPU (runtime/cpu/cpu_backend.h) or a Vulkan device
// (runtime/vulkan/backend/vulkan_backend.h).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "runtime/host/jiggle.h"
#include "runtime/host/stages.h"
#include "runtime/host/weights.h"

namespace bodyopt {

class Executor;
struct Dynamics;

namespace vulkan {
class Buffer;
class Commands;
struct Recording;
}  // namespace vulkan

// A skin on the device, F x V x 3 each, world, metres, vertices in runtime order.
struct DeviceSkin {
  const vulkan::Buffer* positions = nullptr;
  const vulkan::Buffer* normals = nullptr;
};

// One batch as the backends see it: plain arrays, frame-major.
struct Batch {
  std::uint32_t frame_count = 0;
  std::size_t first_frame = 0;        // of the call that this is a batch of: how a check names frames
  std::vector<float> skinning;        // F x J x 12, relative to origin
  std::vector<float> origins;         // F x 4 (the fourth is padding)
  std::vector<float> joint_features;  // F x joint feature count
  std::vector<float> controls;        // F x control count
  std::vector<float> fades;           // F x region count, see region_fades
  std::vector<float> modifiers{};     // F x component count of the modifiers
  // Like skinning, before modifiers turned joints: for the strains. Empty where the basis has none that turn any.
  std::vector<float> learned_skinning{};
  std::vector<double> joints{};       // F x J x 3, metres, world: for the plan of the jiggle
  std::vector<JiggleFrame> jiggle{};  // F; empty: the skin is quasi-static
  bool stays_on_device = false;       // positions and normals are wanted there; those of the result are left alone
  bool wants_normals = true;          // or there are none in the result, and none on the device
  bool wants_tangents = false;        // of a model with their tables; normals are computed for them
  bool keeps_posed = false;           // BatchResult::posed is wanted
};

// The results of a batch, frame-major, vertices in runtime order.
struct BatchResult {
  std::vector<float> positions;     // F x V x 3
  std::vector<float> normals;       // F x V x 3
  std::vector<float> tangents;      // F x O x 4, output vertices, where Batch::wants_tangents
  std::vector<float> posed;         // F x V x 3 where Batch::keeps_posed: the skin of the pose stage
  std::vector<float> strains;       // F x S
  std::vector<float> excess;        // F x feature count: distance outside the trained range, in standard deviations
  std::vector<float> coordinates;   // F x coordinate count, of all regions
  std::vector<float> coefficients;  // F x coefficient count, after subtracting those at rest
  StageSeconds stage_seconds;
};

// The skin of a batch in the backend's memory, until that batch's commands are recorded or run again.
struct SkinValues {
  std::span<const float> positions, normals, tangents;
};

// Backend::run in two halves, so that the work of several goes to their device at once, and the next batch is started
// while one runs: two at most are under way. start() gives ended commands, which must run before finish() takes the
// batch that was started first. The result of this has no skin: skin() reads that in the memory which the device wrote,
// in output order, F x O x 3. Throws as run(), and where the commands have not run.
class SplitRun {
 public:
  virtual vulkan::Commands& start(const Batch& batch) = 0;
  virtual const BatchResult& finish() = 0;
  virtual SkinValues skin() const = 0;

 protected:
  ~SplitRun() = default;
};

class Backend {
 public:
  virtual ~Backend() = default;
  virtual std::string name() const = 0;
  virtual Executor& threads() const;  // for what is done with its results
  // Most frames of one batch of many.
  virtual std::uint32_t batch_limit() const = 0;
  // Most frames of one that stays on the device, or is recorded, such as a crowd.
  virtual std::uint32_t largest_batch() const { return batch_limit(); }
  // The result is the backend's until the next batch, whose memory it is, too. Where it throws the motion is that of
  // before, or no batch runs any more.
  virtual const BatchResult& run(const Batch& batch) = 0;
  virtual SplitRun* split() { return nullptr; }  // null: there is no device between the halves
  // Records a batch for the host program (include/bodyopt/vulkan.h); from then on it does nothing else.
  // Throws Error(usage) where it has no device.
  virtual void record(const Batch&, const vulkan::Recording&);
  virtual void forget_recorded_buffers() {}
  // Coefficients at rest, subtracted from then on. Zero until set.
  virtual void set_rest_coefficients(std::span<const float> coefficients) = 0;
  virtual void set_weights(const Weights& weights) = 0;
  // The skin of the last batch on the device; empty for a backend without one.
  virtual DeviceSkin device_skin() const { return {}; }
  // The motion that batches with jiggle start from, and leave behind. Zero until set.
  virtual void set_motion(const NodeMotion& motion) = 0;
  virtual NodeMotion motion() const = 0;
};

// The dynamics, where there are any, must outlive the backend.
struct JiggleModel {
  const Dynamics* dynamics = nullptr;
  JiggleOptions options;
};

}  // namespace bodyopt
