// A device of the tests as a host program shares its own with the library.
#pragma once

#include "include/bodyopt/bodyopt.hpp"
#include "include/bodyopt/vulkan.h"
#include "runtime/vulkan/device.h"

namespace bodyopt::testing {

inline bodyopt_vulkan_device handles_of(const vulkan::Device& device) {
  auto host = api::make<bodyopt_vulkan_device>();
  host.instance = device.instance();
  host.physical_device = device.physical();
  host.device = device.handle();
  host.queue = device.queue();
  host.queue_family = device.queue_family();
  return host;
}

inline api::Device share(const bodyopt_vulkan_device& host) {
  bodyopt_device* shared = nullptr;
  api::check(bodyopt_share_device(&host, &shared));
  return api::Device(shared);
}

}  // namespace bodyopt::testing
