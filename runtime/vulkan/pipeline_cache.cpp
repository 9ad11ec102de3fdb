#include "runtime/vulkan/pipeline_cache.h"

#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <span>

#include "runtime/basis/read_file.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "runtime/core/text.h"
#include "runtime/vulkan/instance.h"

namespace bodyopt::vulkan {
namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t{256} << 20;  // drivers' are of some megabytes

// One of each device, so that a new driver's takes the place of the old one's.
std::string file_name(const PipelineCacheHeader& header) {
  return "pipelines-" + hexadecimal(std::uint64_t{header.vendor} << 32 | header.device) + ".bin";
}

std::string read_pipelines(const std::filesystem::path& file, const PipelineCacheHeader& header) {
  try {
    return unpack_pipelines(header, read_file(file, kMostBytes, "a pipeline cache"));
  } catch (const Error&) {
    return {};  // none yet, or not for us
  }
}

}  // namespace

PipelineCacheHeader pipeline_cache_header(VkPhysicalDevice physical) {
  auto ids = structure<VkPhysicalDeviceIDProperties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ID_PROPERTIES);
  auto properties = structure<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2);
  properties.pNext = &ids;
  vkGetPhysicalDeviceProperties2(physical, &properties);
  PipelineCacheHeader header;
  header.vendor = properties.properties.vendorID;
  header.device = properties.properties.deviceID;
  header.driver_version = properties.properties.driverVersion;
  std::ranges::copy(ids.driverUUID, header.driver.begin());
  std::ranges::copy(properties.properties.pipelineCacheUUID, header.cache.begin());
  return header;
}

std::string pack_pipelines(PipelineCacheHeader header, const std::string& data) {
  header.size = data.size();
  header.hash = XXH3_64bits(data.data(), data.size());
  return std::string(reinterpret_cast<const char*>(&header), sizeof(header)) + data;
}

std::string unpack_pipelines(const PipelineCacheHeader& driver, const std::string& file) {
  if (file.size() < sizeof(driver)) return {};
  PipelineCacheHeader expected = driver, found;
  std::memcpy(&found, file.data(), sizeof(found));
  expected.size = file.size() - sizeof(found);
  expected.hash = XXH3_64bits(file.data() + sizeof(found), expected.size);
  return found == expected ? file.substr(sizeof(found)) : std::string();
}

PipelineCache::PipelineCache(VkPhysicalDevice physical, VkDevice device, const std::filesystem::path& folder)
    : device_(device), header_(pipeline_cache_header(physical)) {
  if (folder.empty()) return;
  file_ = folder / file_name(header_);
  read_ = read_pipelines(file_, header_);
  auto info = structure<VkPipelineCacheCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO);
  info.initialDataSize = read_.size();
  info.pInitialData = read_.data();
  VkPipelineCache cache = VK_NULL_HANDLE;
  if (vkCreatePipelineCache(device, &info, nullptr, &cache) == VK_SUCCESS) cache_ = {device, cache};
}

PipelineCache::~PipelineCache() {
  if (handle() == VK_NULL_HANDLE) return;
  try {
    save();
  } catch (const std::exception&) {
    // A folder that cannot be written, a full disk: the next process compiles as this one did.
  }
}

void PipelineCache::save() const {
  std::size_t size = 0;
  check(vkGetPipelineCacheData(device_, handle(), &size, nullptr), "vkGetPipelineCacheData");
  std::string data(size, '\0');
  check(vkGetPipelineCacheData(device_, handle(), &size, data.data()), "vkGetPipelineCacheData");
  data.resize(size);
  if (data == read_ || size > kMostBytes - sizeof(header_)) return;
  std::filesystem::create_directories(file_.parent_path());
  const std::string file = pack_pipelines(header_, data);
  write_file_atomically(file_, std::as_bytes(std::span(file)));
}

}  // namespace bodyopt::vulkan
