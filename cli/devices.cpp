// bodyopt devices: what can run a basis here.
#include <nlohmann/json.hpp>

#include "cli/arguments/common.h"
#include "runtime/vulkan/device.h"

namespace bodyopt::cli {

void add_devices(CLI::App& app) {
  auto json = std::make_shared<JsonOption>();
  CLI::App& verb = add_verb(app, "devices", "List the Vulkan devices of this machine");
  json->add(verb);
  verb.callback([json] {
    Json result = Json::array();
    std::string text;
    for (const vulkan::DeviceInfo& device : vulkan::list_devices()) {
      result.push_back({{"index", device.index},
                        {"name", device.name},
                        {"type", device.type},
                        {"driver", device.driver},
                        {"api_version", device.api_version},
                        {"memory_mib", device.memory_bytes >> 20},
                        {"max_storage_buffer_mib", device.max_storage_buffer_range >> 20}});
      text += format("{}  {} ({}), {}, Vulkan {}, {} MiB\n", device.index, device.name, device.type, device.driver,
                     device.api_version, device.memory_bytes >> 20);
    }
    text += "-  cpu (always there)\n";
    json->emit({{"devices", result}}, text);
  });
}

}  // namespace bodyopt::cli
