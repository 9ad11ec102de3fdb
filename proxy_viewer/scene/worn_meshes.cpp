#include "proxy_viewer/scene/worn_meshes.h"

#include <algorithm>
#include <iterator>

#include "runtime/core/error.h"

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
    triangles_.push_back(vulkan::upload(device_, mesh.triangles, "attached triangles"));
  }
}

std::vector<WornMesh> WornMeshes::carry(std::span<const std::vector<float>> skins, std::span<const Pose> poses) const {
  const std::size_t count = attachments_.meshes.size();
  std::vector<std::vector<float>> positions(count), normals(count);
  for (std::size_t f = 0; f < skins.size(); ++f) {
    const std::vector<std::vector<float>> carried = carrier_.carry(skins[f], poses[f].joints);
    for (std::size_t m = 0; m < count; ++m) {
      std::ranges::copy(carried[m], std::back_inserter(positions[m]));
      std::ranges::copy(area_normals(carried[m], attachments_.meshes[m].triangles), std::back_inserter(normals[m]));
    }
  }
  std::vector<WornMesh> meshes;
  for (std::size_t m = 0; m < count; ++m) {
    const AttachedMesh& mesh = attachments_.meshes[m];
    if (sizeof(float) * positions[m].size() > device_.info().max_storage_buffer_range) {
      throw Error(ErrorKind::usage, "mesh '" + mesh.name + "' is too large to be shown " +
                                        std::to_string(skins.size()) +
                                        " times at once: fewer copies or ghosts, or 'worn off'");
    }
    meshes.push_back({&triangles_[m], mesh.triangle_count(),
                      static_cast<std::uint32_t>(positions[m].size() / (3 * std::max<std::size_t>(1, skins.size()))),
                      vulkan::upload(device_, positions[m], "attached positions"),
                      vulkan::upload(device_, normals[m], "attached normals")});
  }
  return meshes;
}

std::vector<float> WornMeshes::points(std::span<const float> skin, const Pose& pose) const {
  std::vector<float> points;
  for (const std::vector<float>& mesh : carrier_.carry(skin, pose.joints)) {
    std::ranges::copy(mesh, std::back_inserter(points));
  }
  return points;
}

}  // namespace bodyopt
