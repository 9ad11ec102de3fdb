// The device that a user asks for.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

namespace bodyopt {

class Executor;

// The backend that runs: "auto", "cpu", an index, or (part of) a name as listed by `bodyopt devices`. The default
// "auto" takes a discrete GPU, then any other, then the CPU. With require_device, it takes a software Vulkan device
// before it throws. A device that exists but fails is an error, never a reason to fall back.
struct DeviceChoice {
  std::string name = "auto";
  bool require_device = false;
  bool validation = false;               // Vulkan validation and synchronization validation; every message is an error
  bool check = false;                    // every stage beside the same on the CPU (runtime/deformer/checked_backend.h)
  std::shared_ptr<Executor> executor{};  // threads of the CPU's kernels; none: oneTBB's
  std::filesystem::path pipeline_cache{};  // folder of what drivers compile (runtime/vulkan/pipeline_cache.h); none: ""
};

}  // namespace bodyopt
