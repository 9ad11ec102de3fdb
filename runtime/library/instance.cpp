// bodyopt.h: instances and their states.
#include <algorithm>

#include "runtime/core/executor.h"
#include "runtime/core/transformed.h"
#include "runtime/host/device_choice.h"
#include "runtime/library/guard.h"
#include "runtime/library/handles.h"

namespace bodyopt {
namespace {

// Threads of the host program.
class HostExecutor final : public Executor {
 public:
  explicit HostExecutor(const bodyopt_executor& host) : host_(host) {}

  void parallel_for(std::size_t count, std::size_t grain, Task task, const void* context) override {
    if (count > 0) host_.parallel_for(host_.host, count, grain, task, context);
  }

 private:
  const bodyopt_executor host_;
};

std::shared_ptr<Executor> lent_threads(const bodyopt_executor* given) {
  if (given == nullptr) return nullptr;
  const auto host = read_struct(given, BODYOPT_EXECUTOR_FIRST_SIZE, "options.executor");
  required(host.parallel_for, "options.executor.parallel_for");
  return std::make_shared<HostExecutor>(host);
}

// The tables of the model on the device: uploaded with the first instance there.
std::shared_ptr<const vulkan::DeviceModel> on_device(const bodyopt_model& model, const bodyopt_device& device) {
  const std::lock_guard lock(model.mutex);
  std::shared_ptr<const vulkan::DeviceModel> shared = model.on_device.lock();
  if (!shared || &shared->device() != device.device.get()) {
    shared = std::make_shared<const vulkan::DeviceModel>(device.device, model.model);
    model.on_device = shared;
  }
  return shared;
}

std::optional<JiggleOptions> jiggle_options(const bodyopt_instance_options& options, const CharacterModel& model) {
  if (options.jiggles == 0) return std::nullopt;
  if (!model.dynamics) {
    throw Error(ErrorKind::usage, "an instance was asked to jiggle, but the model was loaded without dynamics");
  }
  JiggleOptions jiggle;
  std::ranges::copy(options.gravity_change, jiggle.gravity_change.begin());
  return jiggle;
}

const Dynamics& dynamics_of(const bodyopt_instance& instance) {
  const Dynamics* dynamics = instance.deformer->dynamics();
  if (dynamics == nullptr) throw Error(ErrorKind::usage, "the instance does not jiggle: it has no state");
  return *dynamics;
}

// The state of the dynamics that the instance jiggles by. Throws Error(mismatch) for one of others.
const JiggleState& own_state(const bodyopt_state& state, const bodyopt_instance& instance) {
  const Dynamics& dynamics = dynamics_of(instance);
  if (state.model != instance.model && checksum(*state.model->dynamics) != checksum(dynamics)) {
    throw Error(ErrorKind::mismatch,
                "the state is of other dynamics than the instance's: of another character, or of "
                "this one before its dynamics were made again");
  }
  instance.deformer->require_own(state.state);
  return state.state;
}

}  // namespace
}  // namespace bodyopt

using namespace bodyopt;

bodyopt_result bodyopt_create_instance(const bodyopt_model* model, const bodyopt_instance_options* given,
                                       bodyopt_instance** instance) {
  return guarded([&] {
    required(instance, "instance");
    const bodyopt_model& of = required(model, "model");
    bodyopt_instance_options options{};
    if (given != nullptr) options = read_struct(given, BODYOPT_INSTANCE_OPTIONS_FIRST_SIZE, "options");
    const std::optional<JiggleOptions> jiggle = jiggle_options(options, *of.model);
    const std::shared_ptr<Executor> threads = lent_threads(options.executor);
    auto created = std::make_unique<bodyopt_instance>();
    created->model = of.model;
    created->following = of.following;
    created->recorded_frames = std::max(1u, options.recorded_frames);
    created->channels = transformed(of.channels, &ModifierChannel::name);
    created->deformer =
        options.device != nullptr
            ? std::make_unique<Deformer>(on_device(of, *options.device), jiggle, options.check != 0)
            : std::make_unique<Deformer>(of.model, jiggle,
                                         DeviceChoice{.name = "cpu", .check = options.check != 0, .executor = threads});
    if (created->recorded_frames > created->deformer->largest_batch()) {
      throw Error(ErrorKind::usage, "'options.recorded_frames' is ", created->recorded_frames, ", at most ",
                  created->deformer->largest_batch(), " fit on the device");
    }
    if (options.device != nullptr && options.recorded_frames > 0 && !of.following->attached().meshes.empty()) {
      created->attached.emplace(*options.device->device, of.following->tables(), options.recorded_frames);
    }
    *instance = created.release();
  });
}

void bodyopt_release_instance(bodyopt_instance* instance) { delete instance; }

bodyopt_result bodyopt_set_weights(bodyopt_instance* instance, float correction, float jiggle) {
  return guarded(
      [&] { required(instance, "instance").deformer->set_weights({.correction = correction, .jiggle = jiggle}); });
}

bodyopt_result bodyopt_get_state(const bodyopt_instance* instance, bodyopt_state** state) {
  return guarded([&] {
    required(state, "state");
    dynamics_of(required(instance, "instance"));
    *state = new bodyopt_state{instance->deformer->state(), instance->model};
  });
}

bodyopt_result bodyopt_set_state(bodyopt_instance* instance, const bodyopt_state* state) {
  return guarded([&] {
    dynamics_of(required(instance, "instance"));
    instance->deformer->set_state(state != nullptr ? state->state : JiggleState{});
  });
}

void bodyopt_release_state(bodyopt_state* state) { delete state; }

bodyopt_result bodyopt_save_state(const bodyopt_instance* instance, const bodyopt_state* state, const char* path) {
  return guarded([&] {
    const JiggleState& own = own_state(required(state, "state"), required(instance, "instance"));
    save_state(own, dynamics_of(*instance), &required(path, "path"));
  });
}

bodyopt_result bodyopt_load_state(const bodyopt_instance* instance, const char* path, bodyopt_state** state) {
  return guarded([&] {
    required(state, "state");
    *state = new bodyopt_state{load_state(&required(path, "path"), dynamics_of(required(instance, "instance"))),
                               instance->model};
  });
}
