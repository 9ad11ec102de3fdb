#include "runtime/vulkan/kernels/block_buffers.h"

namespace bodyopt::vulkan {
namespace {

constexpr VkDeviceSize kEntryBytes = VkDeviceSize{kMomentWords} * kBlockSize * sizeof(std::uint32_t);

// Three corners of every triangle around every vertex.
std::vector<std::uint32_t> fans_of(const MeshTable& mesh) {
  std::vector<std::uint32_t> fans;
  fans.reserve(3 * mesh.vertex_triangles.size());
  for (const std::uint32_t triangle : mesh.vertex_triangles) {
    const std::uint32_t* corners = mesh.triangles.data() + 3 * std::size_t{triangle};
    fans.insert(fans.end(), corners, corners + 3);
  }
  return fans;
}

// Where the fans of every block of vertices begin, and the end.
std::vector<std::uint32_t> block_begin(const MeshTable& mesh) {
  const std::uint32_t vertices = mesh.vertex_count();
  std::vector<std::uint32_t> begin;
  for (std::uint32_t v = 0; v < vertices; v += kBlockSize) begin.push_back(mesh.vertex_triangle_begin[v]);
  begin.push_back(mesh.vertex_triangle_begin.back());
  return begin;
}

}  // namespace

DdmBuffers::DdmBuffers(const Device& device, const DdmTable& ddm, const DeviceInfo& limits)
    : block_begin(upload_whole(device, ddm.block_begin, "the DDM blocks", limits)),
      block_joints(upload_whole(device, ddm.block_joints, "the DDM joints", limits)),
      moments(upload(device, ddm.moments, "the DDM moments")),
      vertices(upload(device, ddm.vertices, "the DDM vertices")),
      windows(block_windows({ddm.block_begin, kEntryBytes, sizeof(DdmVertex), "the DDM table"}, limits)) {}

FanBuffers::FanBuffers(const Device& device, const MeshTable& mesh, const DeviceInfo& limits)
    : begin(upload_whole(device, mesh.vertex_triangle_begin, "the vertices' fans", limits)),
      triangles(upload(device, fans_of(mesh), "the triangles around vertices")),
      windows(
          block_windows({block_begin(mesh), 3 * sizeof(std::uint32_t), 0, "the triangles around vertices"}, limits)) {}

}  // namespace bodyopt::vulkan
