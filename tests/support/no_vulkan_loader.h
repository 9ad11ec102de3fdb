// For programs that tests run: a machine without Vulkan's loader. The dynamic linker finds an empty file in its place,
// and refuses it; what is linked with the loader does not start.
#pragma once

#include <fstream>
#include <string>

#include "tests/support/temporary_folder.h"

namespace bodyopt {

class NoVulkanLoader {
 public:
  NoVulkanLoader() { std::ofstream(folder_ / "libvulkan.so.1"); }

  // Before a command line.
  std::string environment() const { return "LD_LIBRARY_PATH=" + folder_.path().string() + " "; }

 private:
  TemporaryFolder folder_;
};

}  // namespace bodyopt
