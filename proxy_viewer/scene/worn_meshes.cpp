#include "proxy_viewer/scene/worn_meshes.h"

#include <algorithm>
#include <iterator>

#include "geometry/table_rows.h"
#include "geometry/vertex_normals.h"
#include "runtime/core/error.h"

namespace bodyopt {

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
      const Positions areas = vertex_normals(rows_of(carried[m]), rows_of(attachments_.meshes[m].triangles));
      std::ranges::copy(floats_of(areas), std::back_inserter(normals[m]));
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
