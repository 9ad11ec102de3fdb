#include "runtime/vulkan/functions.h"

#include <dlfcn.h>

namespace bodyopt {

#define BODYOPT_DEFINE(function) PFN_##function function = nullptr;
BODYOPT_VULKAN_FUNCTIONS(BODYOPT_DEFINE)
#undef BODYOPT_DEFINE

namespace vulkan {
namespace {

std::string problem() {
  const char* const text = dlerror();
  return std::string("Vulkan's loader cannot be used here: ") + (text ? text : "no reason given") +
         " (Debian package: libvulkan1)";
}

// The loader stays open: its drivers may not survive being closed.
std::string find_functions() {
  void* const loader = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
  if (loader == nullptr) return problem();
#define BODYOPT_FIND(function)                                           \
  function = reinterpret_cast<PFN_##function>(dlsym(loader, #function)); \
  if (function == nullptr) return problem();
  BODYOPT_VULKAN_FUNCTIONS(BODYOPT_FIND)
#undef BODYOPT_FIND
  return {};
}

}  // namespace

const std::string& missing_functions() {
  static const std::string missing = find_functions();
  return missing;
}

}  // namespace vulkan
}  // namespace bodyopt
