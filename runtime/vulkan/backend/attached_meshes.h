// Meshes that follow a skin on the device.
#pragma once

#include <span>

#include "runtime/host/attach_tables.h"
#include "runtime/vulkan/kernels/kernels.h"

namespace bodyopt::vulkan {

// All instances on a device share its kernels.
struct AttachKernels {
  explicit AttachKernels(const Device& device) : output_stretch(device), output_anchor(device), output_attach(device) {}

  OutputStretch output_stretch;
  OutputAnchor output_anchor;
  OutputAttach output_attach;
};

// Holds the tables of one instance, and intermediate results of `most_frames` frames.
class AttachedMeshes {
 public:
  // The buffer that a mesh goes to, and its layout there.
  struct Target {
    BufferRange range;
    std::uint32_t mesh, first_word, element_words, frame_words;
  };
  // The skin that they follow, on the device: positions F x V x 3, skinning F x J x 12, origins F x 4.
  struct Skin {
    BufferRange positions, skinning, origins;
    std::uint32_t vertex_count, joint_count;
  };

  // Uploads the tables. Throws Error(device) where they do not fit the device.
  AttachedMeshes(const Device& device, const AttachTables& tables, std::uint32_t most_frames);

  std::uint32_t vertex_count(std::size_t mesh) const { return vertex_begin_[mesh + 1] - vertex_begin_[mesh]; }
  void record(Commands& commands, const Skin& skin, std::span<const Target> targets, std::uint32_t frames) const;

 private:
  const AttachKernels& kernels_;
  std::uint32_t corner_count_, anchor_count_;
  std::vector<std::uint32_t> vertex_begin_;  // of each mesh, and the end
  Buffer corners_, fans_, anchors_, points_, vertices_;
  Buffer stretches_, frames_;
};

}  // namespace bodyopt::vulkan
