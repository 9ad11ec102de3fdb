// Attached geometry in the scene: carried on the host, uploaded when it moves.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "runtime/attachments.h"
#include "runtime/vulkan/buffer.h"

namespace bodyopt {

class WornMeshes {
 public:
  struct Mesh {
    vulkan::Buffer triangles, positions, normals;
    std::uint32_t triangle_count = 0;
  };

  // The basis must outlive it.
  WornMeshes(const vulkan::Device& device, const Basis& basis, Attachments attachments);

  // See AttachmentCarrier::carry().
  void carry(std::span<const float> skin, std::span<const JointTransform> joints);

  const std::vector<Mesh>& meshes() const { return meshes_; }

 private:
  const vulkan::Device& device_;
  Attachments attachments_;
  AttachmentCarrier carrier_;
  std::vector<Mesh> meshes_;
};

// By the area vectors of the triangles around each vertex, V x 3; zero where there are none.
std::vector<float> area_normals(std::span<const float> positions, std::span<const std::uint32_t> triangles);

}  // namespace bodyopt
