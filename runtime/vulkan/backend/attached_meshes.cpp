#include "runtime/vulkan/backend/attached_meshes.h"

namespace bodyopt::vulkan {
namespace {

// Before anything is uploaded.
const AttachTables& require_threads_of(const AttachTables& tables, const DeviceInfo& limits) {
  require_threads(tables.corners.size(), "the corners of attached meshes", limits);
  require_threads(tables.anchors.size(), "the anchors of attached meshes", limits);
  require_threads(tables.vertices.size(), "the attached meshes", limits);
  return tables;
}

}  // namespace

AttachedMeshes::AttachedMeshes(const Device& device, const AttachTables& t, std::uint32_t most_frames)
    : kernels_(device.shared<AttachKernels>()),
      corner_count_(static_cast<std::uint32_t>(require_threads_of(t, device.info()).corners.size())),
      anchor_count_(static_cast<std::uint32_t>(t.anchors.size())),
      vertex_begin_(t.vertex_begin),
      corners_(upload_whole(device, t.corners, "the corners of attached meshes", device.info())),
      fans_(upload_whole(device, t.fans, "the fans of attached meshes", device.info())),
      anchors_(upload_whole(device, t.anchors, "the anchors of attached meshes", device.info())),
      points_(upload_whole(device, t.points, "the points of attached meshes", device.info())),
      vertices_(upload_whole(device, t.vertices, "the attached meshes", device.info())) {
  const auto make = [&](std::uint64_t numbers, const char* name) {
    require_binding(sizeof(float) * most_frames * numbers, name, device.info());
    return floats(device, most_frames * numbers, name);
  };
  stretches_ = make(std::uint64_t{kStretchNumbers} * corner_count_, "the skin under attached meshes");
  frames_ = make(std::uint64_t{kAnchorNumbers} * anchor_count_, "the anchors' frames");
}

void AttachedMeshes::record(Commands& commands, const Skin& skin, std::span<const Target> targets,
                            std::uint32_t frames) const {
  kernels_.output_stretch.record(commands, {corners_, fans_, skin.positions, stretches_},
                                 {corner_count_, skin.vertex_count}, frames);
  kernels_.output_anchor.record(
      commands, {anchors_, points_, corners_, stretches_, skin.positions, skin.skinning, skin.origins, frames_},
      {anchor_count_, corner_count_, skin.vertex_count, skin.joint_count}, frames);
  for (const Target& to : targets) {
    kernels_.output_attach.record(
        commands, {vertices_, frames_, to.range},
        {vertex_begin_[to.mesh], vertex_count(to.mesh), anchor_count_, to.first_word, to.element_words, to.frame_words},
        frames);
  }
}

}  // namespace bodyopt::vulkan
