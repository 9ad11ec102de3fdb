// Attached geometry in the scene: carried on the host, uploaded when it moves.
#pragma once

#include <span>
#include <vector>

#include "runtime/host/attachments.h"
#include "runtime/vulkan/buffer.h"

namespace bodyopt {

// A mesh on F skins.
struct WornMesh {
  const vulkan::Buffer* triangles = nullptr;
  std::uint32_t triangle_count = 0, vertex_count = 0;
  vulkan::Buffer positions, normals;  // F x N x 3
};

class WornMeshes {
 public:
  // The basis must outlive it.
  WornMeshes(const vulkan::Device& device, const Basis& basis, Attachments attachments);

  // On each of the skins, O x 3, at its pose. On the device, as long as this lives. Throws Error(usage) for more than
  // the device shows at once.
  std::vector<WornMesh> carry(std::span<const std::vector<float>> skins, std::span<const Pose> poses) const;
  // On the host, all meshes one after the other, N x 3.
  std::vector<float> points(std::span<const float> skin, const Pose& pose) const;

 private:
  const vulkan::Device& device_;
  Attachments attachments_;
  AttachmentCarrier carrier_;
  std::vector<vulkan::Buffer> triangles_;
};

}  // namespace bodyopt
