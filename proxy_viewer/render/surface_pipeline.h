// The pipeline of draw_surface.vert and .frag.
#pragma once

#include <array>
#include <span>

#include "proxy_viewer/render/target.h"

namespace bodyopt {

enum class SurfaceKind : std::uint32_t { clay = 0, coloured = 1, backdrop = 2 };

struct SurfacePush {
  std::array<std::array<float, 4>, 3> view;  // world to camera space, rows
  std::array<float, 4> projection;           // x and y scale; depth = (z projection[2] + projection[3]) / w
  SurfaceKind kind;
  std::uint32_t orthographic;  // w is 1; otherwise (0) it is -z
};
static_assert(sizeof(SurfacePush) == 72);

class SurfacePipeline {
 public:
  static constexpr std::uint32_t kBindings = 4;  // triangles, positions, normals, colours

  SurfacePipeline(const vulkan::Device& device, VkRenderPass render_pass);

  // Recording. Buffers as the shader's bindings; `corners` is three per triangle.
  void bind(VkCommandBuffer commands) const;
  void draw(VkCommandBuffer commands, VkDescriptorSet buffers, const SurfacePush& push, std::uint32_t corners) const;

  VkDescriptorSetLayout set_layout() const { return set_layout_.get(); }

 private:
  void make_layout(VkDevice device);
  void make_pipeline(VkDevice device, VkRenderPass render_pass);

  vulkan::Owned<VkDescriptorSetLayout, vkDestroyDescriptorSetLayout> set_layout_;
  vulkan::Owned<VkPipelineLayout, vkDestroyPipelineLayout> layout_;
  vulkan::Owned<VkPipeline, vkDestroyPipeline> pipeline_;
};

// The descriptor sets of one picture.
class SurfaceSets {
 public:
  SurfaceSets(const vulkan::Device& device, const SurfacePipeline& pipeline, std::uint32_t count);
  // Throws Error(device) when a buffer is larger than the device lets a shader see.
  VkDescriptorSet make(const std::array<const vulkan::Buffer*, SurfacePipeline::kBindings>& buffers);

 private:
  const vulkan::Device& device_;
  VkDescriptorSetLayout layout_;
  vulkan::Owned<VkDescriptorPool, vkDestroyDescriptorPool> pool_;
};

}  // namespace bodyopt
