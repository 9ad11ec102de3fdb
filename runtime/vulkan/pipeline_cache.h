// Pipelines that a driver compiled of shaders, kept in a folder from one process to the next.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "runtime/vulkan/object.h"

namespace bodyopt::vulkan {

// The header before the driver's data in the file. All but its last two fields say for which driver it is.
struct PipelineCacheHeader {
  std::array<char, 8> magic = {'B', 'O', 'D', 'Y', 'P', 'I', 'P', 'E'};
  std::uint32_t version = 1;
  std::uint32_t vendor = 0, device = 0, driver_version = 0;
  std::array<std::uint8_t, VK_UUID_SIZE> driver{}, cache{};  // driverUUID, pipelineCacheUUID
  std::uint64_t size = 0, hash = 0;                          // bytes after the header, and their XXH3

  bool operator==(const PipelineCacheHeader&) const = default;
};
static_assert(sizeof(PipelineCacheHeader) == 72);  // without gaps

// Returns the header for the driver of a device; without size and hash.
PipelineCacheHeader pipeline_cache_header(VkPhysicalDevice physical);
// The file that holds the driver's data.
std::string pack_pipelines(PipelineCacheHeader header, const std::string& data);
// The driver's data that a file holds; empty where the file is damaged or another driver's.
std::string unpack_pipelines(const PipelineCacheHeader& driver, const std::string& file);

class PipelineCache {
 public:
  // Begins with what is in the folder; where nothing there can be read or fits, pipelines are compiled as without. No
  // cache for an empty folder.
  PipelineCache(VkPhysicalDevice physical, VkDevice device, const std::filesystem::path& folder);
  // Keeps what is new, whole or not at all; where it cannot be written, the file stays as it was. Of two processes the
  // last one's stays.
  ~PipelineCache();
  PipelineCache(const PipelineCache&) = delete;
  PipelineCache& operator=(const PipelineCache&) = delete;

  VkPipelineCache handle() const { return cache_.get(); }  // from any thread; VK_NULL_HANDLE: none

 private:
  void save() const;

  VkDevice device_;
  PipelineCacheHeader header_;
  std::filesystem::path file_;
  std::string read_;  // data of the file
  Owned<VkPipelineCache, vkDestroyPipelineCache> cache_;
};

}  // namespace bodyopt::vulkan
