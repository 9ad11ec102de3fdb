// bodyopt.h: Vulkan devices.
#include <algorithm>
#include <string>

#include "runtime/host/device_choice.h"
#include "runtime/library/guard.h"
#include "runtime/library/handles.h"

namespace bodyopt {
namespace {

// Cuts off what does not fit.
template <std::size_t Size>
void copy_text(const std::string& text, char (&to)[Size]) {
  to[text.copy(to, Size - 1)] = 0;
}

bodyopt_device_description describe(const vulkan::DeviceInfo& info, std::size_t struct_size) {
  bodyopt_device_description description{};
  description.struct_size = struct_size;
  description.index = info.index;
  copy_text(info.name, description.name);
  copy_text(info.type, description.type);
  description.memory_bytes = info.memory_bytes;
  copy_text(info.problem, description.problem);
  return description;
}

}  // namespace
}  // namespace bodyopt

using namespace bodyopt;

bodyopt_result bodyopt_list_devices(bodyopt_device_description* devices, size_t room, size_t* count) {
  return guarded([&] {
    required(count, "count");
    const StructArray array(devices, room, BODYOPT_DEVICE_DESCRIPTION_FIRST_SIZE, "devices");
    const std::vector<vulkan::DeviceInfo> found = vulkan::list_devices();
    for (std::size_t k = 0; k < std::min(room, found.size()); ++k) {
      const bodyopt_device_description all = describe(found[k], array.element_size());
      std::memcpy(&array[k], &all, array.element_size());
    }
    *count = found.size();
  });
}

bodyopt_result bodyopt_open_device(const bodyopt_device_options* given, bodyopt_device** device) {
  return guarded([&] {
    required(device, "device");
    bodyopt_device_options options{};
    if (given != nullptr) options = read_struct(given, BODYOPT_DEVICE_OPTIONS_FIRST_SIZE, "options");
    DeviceChoice choice;
    if (options.name != nullptr) choice.name = options.name;
    choice.validation = options.validation != 0;
    if (options.pipeline_cache != nullptr) choice.pipeline_cache = options.pipeline_cache;
    *device = new bodyopt_device{std::make_shared<const vulkan::Device>(choice)};
    write_log(BODYOPT_LOG_INFO, concat("opened the device ", bodyopt_device_name(*device)).c_str());
  });
}

void bodyopt_release_device(bodyopt_device* device) { delete device; }

const char* bodyopt_device_name(const bodyopt_device* device) {
  return device != nullptr ? device->device->info().name.c_str() : nullptr;
}
