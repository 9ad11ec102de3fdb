// bodyopt.h: Vulkan devices.
#include "runtime/host/device_choice.h"
#include "runtime/library/guard.h"
#include "runtime/library/handles.h"

using namespace bodyopt;

bodyopt_result bodyopt_open_device(const bodyopt_device_options* given, bodyopt_device** device) {
  return guarded([&] {
    required(device, "device");
    bodyopt_device_options options{};
    if (given != nullptr) options = read_struct(given, offsetof(bodyopt_device_options, pipeline_cache), "options");
    DeviceChoice choice;
    if (options.name != nullptr) choice.name = options.name;
    choice.validation = options.validation != 0;
    if (options.pipeline_cache != nullptr) choice.pipeline_cache = options.pipeline_cache;
    *device = new bodyopt_device{std::make_shared<const vulkan::Device>(choice)};
  });
}

void bodyopt_release_device(bodyopt_device* device) { delete device; }

const char* bodyopt_device_name(const bodyopt_device* device) {
  return device != nullptr ? device->device->info().name.c_str() : nullptr;
}
