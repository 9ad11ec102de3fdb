#include "runtime/deformer/checked_backend.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "runtime/core/error.h"
#include "runtime/core/extent.h"
#include "runtime/core/text.h"
#include "runtime/host/stages.h"
#include "runtime/host/tolerances.h"

namespace bodyopt {
namespace {

// The output of a stage: `width` numbers of each element, frame-major.
struct StageOutput {
  Stage stage;
  std::span<const float> device, cpu;
  std::size_t width;
  double tolerance;
  std::function<std::string(std::size_t)> element;  // its name
};

std::string number_text(double number) { return formatted("%.9g", number); }

double largest(std::span<const float> values) {
  double most = 0;
  for (const float value : values) most = std::max(most, std::abs(double{value}));
  return most;
}

// Frames of a call that an output is of.
struct Frames {
  std::size_t first, count;
};

void compare(const StageOutput& output, const Frames& frames) {
  const std::size_t stride = std::max<std::size_t>(1, output.cpu.size() / frames.count);
  for (std::size_t k = 0; k < output.cpu.size(); ++k) {
    const double device = output.device[k], cpu = output.cpu[k];
    if (std::abs(device - cpu) <= output.tolerance) continue;  // false, too, where one is not a number
    throw Error(ErrorKind::device, "the check found a difference in the stage '", name_of(output.stage), "', frame ",
                frames.first + k / stride, " of the call, ", output.element(k % stride / output.width),
                ": the device has ", number_text(device), ", the CPU ", number_text(cpu), ", the tolerance is ",
                number_text(output.tolerance), "; likely a defect of the device's driver or of the kernel");
  }
}

class CheckedBackend final : public Backend {
 public:
  CheckedBackend(std::shared_ptr<const CharacterModel> model, std::unique_ptr<Backend> device,
                 std::unique_ptr<Backend> cpu)
      : model_(std::move(model)),
        device_(std::move(device)),
        cpu_(std::move(cpu)),
        size_(box_diagonal(model_->basis.mesh.rest)) {}

  std::string name() const override { return device_->name(); }
  std::uint32_t batch_limit() const override { return std::min(device_->batch_limit(), cpu_->batch_limit()); }
  std::uint32_t largest_batch() const override { return device_->largest_batch(); }
  DeviceSkin device_skin() const override { return device_->device_skin(); }
  NodeMotion motion() const override { return device_->motion(); }

  void set_rest_coefficients(std::span<const float> coefficients) override {
    for (Backend* backend : {device_.get(), cpu_.get()}) backend->set_rest_coefficients(coefficients);
  }
  void set_weights(const Weights& weights) override {
    for (Backend* backend : {device_.get(), cpu_.get()}) backend->set_weights(weights);
  }
  void set_motion(const NodeMotion& motion) override {
    for (Backend* backend : {device_.get(), cpu_.get()}) backend->set_motion(motion);
  }

  const BatchResult& run(const Batch& given) override {
    if (given.frame_count == 0) return device_->run(given);
    Batch batch = given;
    batch.stays_on_device = false;
    batch.keeps_posed = true;
    batch.wants_normals = given.wants_normals || given.wants_tangents;  // what tangents come of is compared, too
    const std::optional<NodeMotion> before = batch.jiggle.empty() ? std::nullopt : std::optional(cpu_->motion());
    try {
      return checked(batch);
    } catch (...) {
      if (before) set_motion(*before);  // as Backend::run promises
      throw;
    }
  }

 private:
  const BatchResult& checked(const Batch& batch) {
    const BatchResult& found = device_->run(batch);
    const BatchResult& expected = cpu_->run(batch);
    const Frames frames{batch.first_frame, batch.frame_count};
    if (!batch.jiggle.empty()) device_motion_ = device_->motion();
    for (const Stage stage : stages_of(model_->basis, batch)) check(stage, found, expected, frames);
    if (!batch.jiggle.empty()) cpu_->set_motion(device_motion_);
    return found;
  }

  void check(Stage stage, const BatchResult& found, const BatchResult& expected, const Frames& frames) {
    const Frames last{frames.first + frames.count - 1, 1};  // the motion is that after it
    switch (stage) {
      case Stage::rig:
        return;  // on the host
      case Stage::modify:
        return;  // seen in what is posed
      case Stage::strain:
        return compare(fibres(tolerance_of(Stage::strain, "strains"), found.strains, expected.strains), frames);
      case Stage::residual:
        compare(numbers(tolerance_of(Stage::residual, "excess"), "feature", 1, found.excess, expected.excess), frames);
        return compare(numbers(tolerance_of(Stage::residual, "coefficients"), "coefficient", 1, found.coefficients,
                               expected.coefficients),
                       frames);
      case Stage::pose:
        return compare(vertices(tolerance_of(Stage::pose, "posed"), found.posed, expected.posed), frames);
      case Stage::diffuse:
        return compare(
            numbers(tolerance_of(Stage::diffuse, "nodes"), "node", 3, device_motion_.nodes, cpu_->motion().nodes),
            last);
      case Stage::jiggle:
        compare(numbers(tolerance_of(Stage::jiggle, "displacement"), "node", 3, device_motion_.displacement,
                        cpu_->motion().displacement),
                last);
        return compare(vertices(tolerance_of(Stage::jiggle, "positions"), found.positions, expected.positions), frames);
      case Stage::output:
        compare(vertices(tolerance_of(Stage::output, "positions"), found.positions, expected.positions), frames);
        compare(vertices(tolerance_of(Stage::output, "normals"), found.normals, expected.normals), frames);
        return compare(numbers(tolerance_of(Stage::output, "tangents"), "vertex", 4, found.tangents, expected.tangents),
                       frames);
    }
  }

  double allowed(const StageTolerance& tolerance, std::span<const float> cpu) const {
    return tolerance.absolute + tolerance.of_size * size_ + tolerance.of_largest * std::max(1.0, largest(cpu));
  }

  StageOutput fibres(const StageTolerance& tolerance, std::span<const float> device, std::span<const float> cpu) const {
    return {tolerance.stage, device, cpu, 1, allowed(tolerance, cpu), [this](std::size_t k) {
              return "fibre " + model_->basis.strain.names[k];
            }};
  }

  // `size` of each: "node 3".
  StageOutput numbers(const StageTolerance& tolerance, const std::string& what, std::size_t size,
                      std::span<const float> device, std::span<const float> cpu) const {
    return {tolerance.stage, device, cpu, size, allowed(tolerance, cpu), [what](std::size_t k) {
              return what + " " + std::to_string(k);
            }};
  }

  // Names a vertex by its number in the character's file.
  StageOutput vertices(const StageTolerance& tolerance, std::span<const float> device,
                       std::span<const float> cpu) const {
    return {tolerance.stage, device, cpu, 3, allowed(tolerance, cpu), [this](std::size_t k) {
              const std::vector<std::uint32_t>& output = model_->basis.mesh.output_vertex;
              return "vertex " + std::to_string(std::ranges::find(output, k) - output.begin());
            }};
  }

  std::shared_ptr<const CharacterModel> model_;
  std::unique_ptr<Backend> device_, cpu_;
  double size_;               // metres
  NodeMotion device_motion_;  // after the batch under check
};

}  // namespace

std::unique_ptr<Backend> make_checked_backend(std::shared_ptr<const CharacterModel> model,
                                              std::unique_ptr<Backend> device, std::unique_ptr<Backend> cpu) {
  return std::make_unique<CheckedBackend>(std::move(model), std::move(device), std::move(cpu));
}

}  // namespace bodyopt
