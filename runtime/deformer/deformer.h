// The runtime: runs rig, strain, residual, modify, pose, diffuse, jiggle and output for a batch of poses, on the CPU or
// on a Vulkan device.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/deformer/evaluation.h"
#include "runtime/host/jiggle.h"
#include "runtime/host/weights.h"

namespace bodyopt {

class Backend;
class Executor;
struct Basis;
struct Batch;
struct CallMemory;
struct CharacterModel;
struct DeformerCall;
struct DeviceChoice;
struct DeviceSkin;
struct Pose;

namespace vulkan {
class Device;
class DeviceModel;
struct Recording;
}  // namespace vulkan

// The mean over the regions of frame k: how much is left of what was learned. 1 without regions.
double mean_fade(const Evaluation& evaluation, std::size_t k);

// "joint LeftArm", "place of joint LeftArm", "strain biceps/1" or "control breath": what a feature of the residual is
// of.
std::string feature_name(const Basis& basis, std::uint32_t feature);
// Evaluation::outside_by as people say it: "12.3 degrees", "4.5 mm", "4.5 % of its length", "20.0 %" of a control.
std::string outside_text(const Basis& basis, std::uint32_t feature, float by);

// True when there is a Vulkan device that works, be it a software one. Does not throw: a machine without a Vulkan
// driver has none.
bool has_vulkan_device();
// True when one of them is no software: "auto" takes it.
bool has_gpu();

class Deformer {
 public:
  // Validates the basis, takes the device, uploads the tables, records the coefficients at rest.
  Deformer(Basis basis, const DeviceChoice& choice);
  // Adds dynamics, which must belong to the basis (load_dynamics ensures that). This and all that take JiggleOptions
  // throw Error(usage) where these are out of their ranges.
  Deformer(Basis basis, Dynamics dynamics, const JiggleOptions& options, const DeviceChoice& choice);
  // An instance of a model that others share. `jiggle`: none for the quasi-static skin, or the model must have
  // dynamics.
  Deformer(std::shared_ptr<const CharacterModel> model, const std::optional<JiggleOptions>& jiggle,
           const DeviceChoice& choice);
  // An instance of a model on a device that others use as well, to draw the skin where it is. It has buffers and state
  // of its own, and the model's tables and pipelines. `jiggle`: as above. `check`: see DeviceChoice.
  explicit Deformer(std::shared_ptr<const vulkan::DeviceModel> model,
                    const std::optional<JiggleOptions>& jiggle = std::nullopt, bool check = false);
  // An instance on the CPU whose skin a software device draws; see runtime/deformer/drawn_backend.h. `jiggle`: as
  // above.
  Deformer(const std::shared_ptr<const CharacterModel>& model, std::shared_ptr<const vulkan::Device> drawn_on,
           const std::optional<JiggleOptions>& jiggle);
  ~Deformer();

  // Quasi-static skin. Any number of poses; split into batches as the device allows. Throws Error(mismatch) when a pose
  // does not fit the skeleton, Error(device) when the device fails.
  Evaluation evaluate(std::span<const Pose> poses);
  // The skin with jiggle, in the order given; frames: number of each pose, JiggleStep::frames_per_second apart. It goes
  // on from the frames of earlier calls, however they are cut into calls: the bits are the same. Throws as above, and
  // Error(usage) without dynamics; the state is then that of before.
  Evaluation jiggle(std::span<const Pose> poses, std::span<const int> frames);

  // Records frames into a command buffer of the host program; see Backend::record. `frames`: a number of each pose
  // where they jiggle. Throws Error(usage) above largest_batch(), and above most_frames of the first recording.
  void record(std::span<const Pose> poses, std::optional<std::span<const int>> frames,
              const vulkan::Recording& recording);
  void forget_recorded_buffers();
  // Returns the skin of the last batch; its buffers live until the next call that evaluates.
  DeviceSkin device_skin() const;
  std::uint32_t batch_limit() const;
  std::uint32_t largest_batch() const;
  Executor& threads() const;  // for what is made of its skins on the host
  // Throws Error(usage) for more poses than largest_batch().
  void require_one_batch(std::span<const Pose> poses) const;

  // Throws Error(usage) for a weight that is not within kMostWeight of 0.
  void set_weights(const Weights& weights);
  // Whether an Evaluation gets normals, which take time. By default it does. A SkinPlace says so itself.
  void set_normals(bool wanted) { wants_normals_ = wanted; }

  JiggleState state() const;
  // Throws Error(mismatch) where the state does not fit the character or holds a number that is not finite.
  void require_own(const JiggleState& state) const;
  // Throws as above.
  void set_state(const JiggleState& state);

  const Basis& basis() const;
  const JiggleOptions& jiggle_options() const { return options_; }
  const Dynamics* dynamics() const;
  std::string device_name() const;

 private:
  friend class RunningCall;  // of runtime/deformer/evaluate_together.cpp

  Deformer(std::shared_ptr<const CharacterModel> model, const std::optional<JiggleOptions>& jiggle,
           std::unique_ptr<Backend> backend);
  void set_rest();
  Evaluation run(DeformerCall call);
  // Throws Error(usage) where no texture coordinates were given.
  void require_tangents() const;
  void plan(std::span<const int> frames, Batch& batch);

  std::shared_ptr<const CharacterModel> model_;
  bool jiggles_;
  JiggleOptions options_;
  double size_ = 0;  // of the character, metres
  Weights weights_;
  bool wants_normals_ = true;
  JiggleState state_;  // its motion is the backend's
  std::unique_ptr<Backend> backend_;
  std::unique_ptr<CallMemory> memory_;
};

}  // namespace bodyopt
