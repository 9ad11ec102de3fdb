#include "runtime/vulkan/kernels/ddm_buffers.h"

namespace bodyopt::vulkan {
namespace {

constexpr VkDeviceSize kEntryBytes = VkDeviceSize{kMomentWords} * kBlockSize * sizeof(std::uint32_t);

}  // namespace

DdmBuffers::DdmBuffers(const Device& device, const DdmTable& ddm, const DeviceInfo& limits)
    : block_begin(upload_whole(device, ddm.block_begin, "the DDM blocks", limits)),
      block_joints(upload_whole(device, ddm.block_joints, "the DDM joints", limits)),
      moments(upload(device, ddm.moments, "the DDM moments")),
      vertices(upload(device, ddm.vertices, "the DDM vertices")),
      windows(block_windows({ddm.block_begin, kEntryBytes, sizeof(DdmVertex), "the DDM table"}, limits)) {}

}  // namespace bodyopt::vulkan
