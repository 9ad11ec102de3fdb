#include "runtime/vulkan/functions.h"

#include <dlfcn.h>

#include <mutex>
#include <string_view>

#include "runtime/core/error.h"

namespace bodyopt {

#define BODYOPT_DEFINE(function) PFN_##function function = nullptr;
BODYOPT_VULKAN_FUNCTIONS(BODYOPT_DEFINE)
#undef BODYOPT_DEFINE

namespace vulkan {
namespace {

std::mutex functions_mutex;
bool has_functions = false;

std::string problem() {
  const char* const text = dlerror();
  return std::string("Vulkan's loader cannot be used here: ") + (text ? text : "no reason given") +
         " (Debian package: libvulkan1)";
}

// The loader stays open: its drivers may not survive being closed.
std::string find_in_system() {
  void* const loader = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
  if (loader == nullptr) return problem();
#define BODYOPT_FIND(function)                                           \
  function = reinterpret_cast<PFN_##function>(dlsym(loader, #function)); \
  if (function == nullptr) return problem();
  BODYOPT_VULKAN_FUNCTIONS(BODYOPT_FIND)
#undef BODYOPT_FIND
  return {};
}

PFN_vkGetInstanceProcAddr finder_in_system() {
  void* const loader = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
  return loader ? reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(loader, "vkGetInstanceProcAddr")) : nullptr;
}

// Functions that are called before there is an instance are not found by way of one. Those of a window are there where
// the host has one.
PFN_vkVoidFunction find_by(PFN_vkGetInstanceProcAddr find, VkInstance instance, const char* name) {
  const PFN_vkVoidFunction function = find(instance, name);
  return function != nullptr ? function : find(VK_NULL_HANDLE, name);
}

std::string find_in_host(VkInstance instance, PFN_vkGetInstanceProcAddr find) {
#define BODYOPT_FIND(function)                                                     \
  function = reinterpret_cast<PFN_##function>(find_by(find, instance, #function)); \
  if (function == nullptr && !std::string_view(#function).ends_with("KHR"))        \
    return "the host's get_instance_proc_addr does not know " #function;
  BODYOPT_VULKAN_FUNCTIONS(BODYOPT_FIND)
#undef BODYOPT_FIND
  vkGetInstanceProcAddr = find;
  return {};
}

// Two ways to ask one loader give the same functions.
bool is_same_loader(PFN_vkGetInstanceProcAddr a, PFN_vkGetInstanceProcAddr b) {
  const char* const name = "vkCreateInstance";
  return a == b || a(VK_NULL_HANDLE, name) == b(VK_NULL_HANDLE, name);
}

}  // namespace

std::string missing_functions() {
  const std::lock_guard lock(functions_mutex);
  if (has_functions) return {};
  const std::string missing = find_in_system();
  has_functions = missing.empty();
  return missing;
}

void find_functions(VkInstance instance, PFN_vkGetInstanceProcAddr find) {
  const std::lock_guard lock(functions_mutex);
  if (has_functions) {
    const PFN_vkGetInstanceProcAddr asked = find ? find : finder_in_system();
    if (asked && is_same_loader(asked, vkGetInstanceProcAddr)) return;
    throw Error(ErrorKind::device,
                "the host's get_instance_proc_addr is of another loader of Vulkan than the one in use, of which a "
                "process has one: share the device before any other is listed, opened or shared");
  }
  const std::string missing = find ? find_in_host(instance, find) : find_in_system();
  if (!missing.empty()) throw Error(ErrorKind::device, missing);
  has_functions = true;
}

}  // namespace vulkan
}  // namespace bodyopt
