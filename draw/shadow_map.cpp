#include "draw/shadow_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "view_blur.frag.spv.h"
#include "view_blur.vert.spv.h"
#include "view_shadow.frag.spv.h"
#include "view_shadow.vert.spv.h"

namespace bodyopt::draw {
namespace {

constexpr std::uint32_t kSide = 512;  // pixels
constexpr float kCasterShare = 0.5f;  // of the map's side: the pixels of one caster
constexpr Sampling kClampedSampling{VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE};
constexpr VkFormat kFormat = VK_FORMAT_R8_UNORM;
constexpr float kReach = 1.1f;  // of the caster's radius: what is higher casts no shadow

struct ShadowPush {
  std::array<float, 4> shadow, offset_reach;
  std::uint32_t first_vertex;
};

constexpr VkRect2D kWhole{{0, 0}, {kSide, kSide}};
// Without a shadow nothing is drawn or read, but the ground's set still names the image, in this layout.
constexpr ImagePassage kUnread{VK_IMAGE_LAYOUT_UNDEFINED,
                               VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                               VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT,
                               VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT,
                               0,
                               VK_ACCESS_SHADER_READ_BIT};

float caster_radius(const View& view) { return view.ground.caster > 0 ? view.ground.caster : view.radius; }

// Returns the part with shadows: to blur all else would take long.
VkRect2D used_part(const View& view) {
  const float half = std::ceil(0.5f * kSide * shadow_scale(view) * view.radius) + 1;
  const auto used = static_cast<std::uint32_t>(std::min(half, 0.5f * kSide));
  const auto corner = static_cast<std::int32_t>(kSide / 2 - used);
  return {{corner, corner}, {2 * used, 2 * used}};
}

RenderPass make_pass(const vulkan::Device& device) {
  const VkAccessFlags writes = VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
  const std::array dependencies = {
      VkSubpassDependency{VK_SUBPASS_EXTERNAL, 0, VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT,
                          VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT, VK_ACCESS_SHADER_READ_BIT, writes, 0},
      VkSubpassDependency{0, VK_SUBPASS_EXTERNAL, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                          VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT, VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                          VK_ACCESS_SHADER_READ_BIT, 0}};
  return make_colour_pass(device,
                          {kFormat, VK_SAMPLE_COUNT_1_BIT, VK_ATTACHMENT_LOAD_OP_CLEAR, VK_ATTACHMENT_STORE_OP_STORE,
                           VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL},
                          dependencies);
}

Attachment make_picture(const vulkan::Device& device) {
  return make_attachment(device, {{kSide, kSide},
                                  kFormat,
                                  VK_SAMPLE_COUNT_1_BIT,
                                  VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT});
}

}  // namespace

float shadow_scale(const View& view) { return std::min(kCasterShare / caster_radius(view), 1 / view.radius); }

ShadowMap::Pipelines::Pipelines(const vulkan::Device& device)
    : pass(make_pass(device)),
      draw(device, pass.get(),
           {.vertex = view_shadow_vert_spv,
            .fragment = view_shadow_frag_spv,
            .storage_buffers = 1,
            .push_bytes = sizeof(ShadowPush),
            .samples = VK_SAMPLE_COUNT_1_BIT,
            .blending = Blending::greatest,
            .depth_test = false,
            .depth_write = false}),
      blur(device, pass.get(),
           {.vertex = view_blur_vert_spv,
            .fragment = view_blur_frag_spv,
            .sampled_images = 1,
            .push_bytes = sizeof(float),
            .samples = VK_SAMPLE_COUNT_1_BIT,
            .depth_test = false,
            .depth_write = false}) {}

ShadowMap::ShadowMap(const vulkan::Device& device)
    : pipelines_(device.shared<Pipelines>()),
      hard_(make_picture(device)),
      soft_(make_picture(device)),
      hard_framebuffer_(make_framebuffer(device, pipelines_.pass.get(), {kSide, kSide}, {hard_.view.get()})),
      soft_framebuffer_(make_framebuffer(device, pipelines_.pass.get(), {kSide, kSide}, {soft_.view.get()})),
      sampler_(make_sampler(device, kClampedSampling)) {}

void ShadowMap::begin(VkCommandBuffer commands, VkFramebuffer framebuffer, const VkRect2D& part) const {
  begin_pass(commands, pipelines_.pass.get(), framebuffer, kWhole.extent);
  const VkViewport viewport{0, 0, kSide, kSide, 0, 1};
  vkCmdSetViewport(commands, 0, 1, &viewport);
  vkCmdSetScissor(commands, 0, 1, &part);
}

void ShadowMap::record(VkCommandBuffer commands, PictureSets& sets, const View& view) const {
  if (view.ground.shadow <= 0) {
    pass_on(commands, soft_.image.get(), kUnread);
    return;
  }
  const float scale = shadow_scale(view), caster = caster_radius(view);
  begin(commands, hard_framebuffer_.get(), kWhole);
  const GraphicsPipeline &draw = pipelines_.draw, &blur = pipelines_.blur;
  draw.bind(commands);
  for (const SkinDraw& skin : view.skins) {
    if (!skin.shadow) continue;
    const ShadowPush push{{view.middle[0], view.middle[2], scale, view.ground.height},
                          {skin.offset[0], skin.offset[1], skin.offset[2], 1 / (kReach * caster)},
                          skin.first_vertex};
    draw.draw(commands, sets.make(draw, {skin.positions}), push, 3 * skin.triangle_count, skin.triangles);
  }
  vkCmdEndRenderPass(commands);
  begin(commands, soft_framebuffer_.get(), used_part(view));
  blur.bind(commands);
  blur.draw(commands, sets.make(blur, {}, {{hard_.view.get(), sampler_.get()}}), scale * caster, 3);
  vkCmdEndRenderPass(commands);
}

}  // namespace bodyopt::draw
