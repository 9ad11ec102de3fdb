// How near the ground skins are, seen from above: their soft shadow.
#pragma once

#include "draw/graphics_pipeline.h"
#include "draw/texture.h"
#include "draw/view.h"

namespace bodyopt::draw {

// Half sides of the map a metre of ground takes. The map's middle is the view's; a caster has as many pixels whether it
// stands alone or in a crowd, until the map is full.
float shadow_scale(const View& view);

class ShadowMap {
 public:
  explicit ShadowMap(const vulkan::Device& device);

  // Recording, outside of a render pass: what the skins of the view leave on its ground.
  void record(VkCommandBuffer commands, PictureSets& sets, const View& view) const;

  SampledImage image() const { return {soft_.view.get(), sampler_.get()}; }

 private:
  // Clears all, and draws into the part alone.
  void begin(VkCommandBuffer commands, VkFramebuffer framebuffer, const VkRect2D& part) const;

  // All shadow maps of a device share one.
  struct Pipelines {
    explicit Pipelines(const vulkan::Device& device);

    RenderPass pass;
    GraphicsPipeline draw, blur;
  };

  const Pipelines& pipelines_;
  Attachment hard_, soft_;
  Framebuffer hard_framebuffer_, soft_framebuffer_;
  Sampler sampler_;
};

}  // namespace bodyopt::draw
