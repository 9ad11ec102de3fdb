#include "proxy_viewer/worn_meshes.h"

namespace bodyopt {

std::vector<float> area_normals(std::span<const float> positions, std::span<const std::uint32_t> triangles) {
  std::vector<float> normals(positions.size(), 0.0f);
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
    const float* corner[3];
    for (std::size_t k = 0; k < 3; ++k) corner[k] = positions.data() + std::size_t{3} * triangles[t + k];
    float a[3], b[3];
    for (std::size_t i = 0; i < 3; ++i) {
      a[i] = corner[1][i] - corner[0][i];
      b[i] = corner[2][i] - corner[0][i];
    }
    const float area[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < 3; ++i) normals[std::size_t{3} * triangles[t + k] + i] += area[i];
    }
  }
  return normals;
}

WornMeshes::WornMeshes(const vulkan::Device& device, const Basis& basis, Attachments attachments)
    : device_(device), attachments_(std::move(attachments)), carrier_(basis, attachments_) {
  for (const AttachedMesh& mesh : attachments_.meshes) {
    meshes_.push_back({vulkan::upload(device_, mesh.triangles, "attached triangles"), {}, {}, mesh.triangle_count()});
  }
}

void WornMeshes::carry(std::span<const float> skin, std::span<const JointTransform> joints) {
  const std::vector<std::vector<float>> carried = carrier_.carry(skin, joints);
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    meshes_[m].positions = vulkan::upload(device_, carried[m], "attached positions");
    meshes_[m].normals =
        vulkan::upload(device_, area_normals(carried[m], attachments_.meshes[m].triangles), "attached normals");
  }
}

}  // namespace bodyopt
