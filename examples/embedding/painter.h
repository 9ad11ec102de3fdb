// Draws surfaces into a picture by plain Vulkan, as an engine does anyway; nothing here is of Bodyopt but the memory
// that it may write, Surface::output().
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "engine.h"
#include "surface_frag.h"
#include "surface_vert.h"

inline constexpr std::uint32_t kSize = 256;  // of a picture, pixels

struct Constants {
  std::array<float, 4> box, colour;
};

// The vertices and triangles of a mesh, where the device draws them.
struct Surface {
  Surface(const Engine& engine, std::uint32_t vertices, std::uint32_t triangles, std::array<float, 4> colour_)
      : positions(engine, VkDeviceSize{12} * vertices, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT),
        indices(engine, VkDeviceSize{12} * triangles, VK_BUFFER_USAGE_INDEX_BUFFER_BIT),
        index_count(3 * triangles),
        colour(colour_) {}

  bodyopt_floats output() const { return {static_cast<float*>(positions.mapped), positions.size, 0, 0}; }
  std::uint32_t* triangles() const { return static_cast<std::uint32_t*>(indices.mapped); }

  Buffer positions, indices;
  std::uint32_t index_count;
  std::array<float, 4> colour;
};

// A picture with a depth, and the pipeline that draws surfaces into it.
class Painter {
 public:
  explicit Painter(const Engine& engine)
      : engine_(engine),
        pixels_(engine, VkDeviceSize{4} * kSize * kSize, VK_BUFFER_USAGE_TRANSFER_DST_BIT),
        colour_(engine, VK_FORMAT_R8G8B8A8_UNORM, VK_IMAGE_ASPECT_COLOR_BIT,
                VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT),
        depth_(engine, VK_FORMAT_D32_SFLOAT, VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT) {
    make_pass();
    make_pipeline();
  }
  Painter(const Painter&) = delete;
  ~Painter() {
    vkDestroyPipeline(engine_.device, pipeline_, nullptr);
    vkDestroyPipelineLayout(engine_.device, layout_, nullptr);
    vkDestroyFramebuffer(engine_.device, framebuffer_, nullptr);
    vkDestroyRenderPass(engine_.device, pass_, nullptr);
  }

  // Four bytes of each pixel, which live until the next call.
  const unsigned char* draw(const std::vector<const Surface*>& surfaces, const std::array<float, 4>& box) const {
    engine_.begin();
    const VkClearValue clear[2] = {{.color = {{1, 1, 1, 1}}}, {.depthStencil = {1, 0}}};
    const VkRenderPassBeginInfo begin{
        VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO, nullptr, pass_, framebuffer_, {{0, 0}, {kSize, kSize}}, 2, clear};
    vkCmdBeginRenderPass(engine_.commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
    vkCmdBindPipeline(engine_.commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_);
    for (const Surface* surface : surfaces) {
      const Constants constants{box, surface->colour};
      const VkDeviceSize offset = 0;
      vkCmdPushConstants(engine_.commands, layout_, kStages, 0, sizeof(constants), &constants);
      vkCmdBindVertexBuffers(engine_.commands, 0, 1, &surface->positions.handle, &offset);
      vkCmdBindIndexBuffer(engine_.commands, surface->indices.handle, 0, VK_INDEX_TYPE_UINT32);
      vkCmdDrawIndexed(engine_.commands, surface->index_count, 1, 0, 0, 0);
    }
    vkCmdEndRenderPass(engine_.commands);
    VkBufferImageCopy copy{};
    copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    copy.imageExtent = {kSize, kSize, 1};
    vkCmdCopyImageToBuffer(engine_.commands, colour_.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, pixels_.handle, 1,
                           &copy);
    engine_.submit(VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT);
    return static_cast<const unsigned char*>(pixels_.mapped);
  }

 private:
  static constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

  struct Image {
    Image(const Engine& engine, VkFormat format_, VkImageAspectFlags aspect, VkImageUsageFlags usage)
        : format(format_), device(engine.device) {
      VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
      info.imageType = VK_IMAGE_TYPE_2D;
      info.format = format;
      info.extent = {kSize, kSize, 1};
      info.mipLevels = info.arrayLayers = 1;
      info.samples = VK_SAMPLE_COUNT_1_BIT;
      info.usage = usage;
      require(vkCreateImage(device, &info, nullptr, &handle));
      VkMemoryRequirements needs;
      vkGetImageMemoryRequirements(device, handle, &needs);
      memory = engine.allocate(needs, 0);
      require(vkBindImageMemory(device, handle, memory, 0));
      VkImageViewCreateInfo of{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
      of.image = handle;
      of.viewType = VK_IMAGE_VIEW_TYPE_2D;
      of.format = format;
      of.subresourceRange = {aspect, 0, 1, 0, 1};
      require(vkCreateImageView(device, &of, nullptr, &view));
    }
    Image(const Image&) = delete;
    ~Image() {
      vkDestroyImageView(device, view, nullptr);
      vkDestroyImage(device, handle, nullptr);
      vkFreeMemory(device, memory, nullptr);
    }

    VkFormat format;
    VkDevice device;
    VkImage handle{};
    VkDeviceMemory memory{};
    VkImageView view{};
  };

  static VkAttachmentDescription cleared(VkFormat format, VkAttachmentStoreOp store, VkImageLayout last) {
    VkAttachmentDescription description{};
    description.format = format;
    description.samples = VK_SAMPLE_COUNT_1_BIT;
    description.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    description.storeOp = store;
    description.finalLayout = last;
    return description;
  }

  void make_pass() {
    const VkAttachmentDescription attachments[] = {
        cleared(colour_.format, VK_ATTACHMENT_STORE_OP_STORE, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL),
        cleared(depth_.format, VK_ATTACHMENT_STORE_OP_DONT_CARE, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL)};
    const VkAttachmentReference colour{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    const VkAttachmentReference depth{1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
    VkSubpassDescription subpass{};
    subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
    subpass.colorAttachmentCount = 1;
    subpass.pColorAttachments = &colour;
    subpass.pDepthStencilAttachment = &depth;
    const VkSubpassDependency copied{0,
                                     VK_SUBPASS_EXTERNAL,
                                     VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                                     VK_PIPELINE_STAGE_TRANSFER_BIT,
                                     VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                                     VK_ACCESS_TRANSFER_READ_BIT,
                                     0};
    const VkRenderPassCreateInfo info{
        VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO, nullptr, 0, 2, attachments, 1, &subpass, 1, &copied};
    require(vkCreateRenderPass(engine_.device, &info, nullptr, &pass_));
    const VkImageView views[] = {colour_.view, depth_.view};
    const VkFramebufferCreateInfo frame{
        VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO, nullptr, 0, pass_, 2, views, kSize, kSize, 1};
    require(vkCreateFramebuffer(engine_.device, &frame, nullptr, &framebuffer_));
  }

  template <std::size_t Words>
  VkShaderModule module_of(const std::uint32_t (&words)[Words]) const {
    const VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, nullptr, 0, sizeof(words), words};
    VkShaderModule module{};
    require(vkCreateShaderModule(engine_.device, &info, nullptr, &module));
    return module;
  }

  void make_pipeline() {
    const VkPushConstantRange range{kStages, 0, sizeof(Constants)};
    const VkPipelineLayoutCreateInfo layout{
        VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO, nullptr, 0, 0, nullptr, 1, &range};
    require(vkCreatePipelineLayout(engine_.device, &layout, nullptr, &layout_));
    const VkShaderModule modules[] = {module_of(surface_vert), module_of(surface_frag)};
    VkPipelineShaderStageCreateInfo stages[2]{};
    for (std::size_t k = 0; k < 2; ++k) {
      stages[k].sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
      stages[k].stage = k == 0 ? VK_SHADER_STAGE_VERTEX_BIT : VK_SHADER_STAGE_FRAGMENT_BIT;
      stages[k].module = modules[k];
      stages[k].pName = "main";
    }
    const VkVertexInputBindingDescription binding{0, 12, VK_VERTEX_INPUT_RATE_VERTEX};
    const VkVertexInputAttributeDescription attribute{0, 0, VK_FORMAT_R32G32B32_SFLOAT, 0};
    const VkPipelineVertexInputStateCreateInfo input{
        VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO, nullptr, 0, 1, &binding, 1, &attribute};
    VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
    assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    const VkViewport viewport{0, 0, kSize, kSize, 0, 1};
    const VkRect2D scissor{{0, 0}, {kSize, kSize}};
    const VkPipelineViewportStateCreateInfo area{
        VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, nullptr, 0, 1, &viewport, 1, &scissor};
    VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
    raster.lineWidth = 1;
    VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
    samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
    VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
    depth.depthTestEnable = depth.depthWriteEnable = VK_TRUE;
    depth.depthCompareOp = VK_COMPARE_OP_LESS;
    VkPipelineColorBlendAttachmentState opaque{};
    opaque.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT;
    VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
    blend.attachmentCount = 1;
    blend.pAttachments = &opaque;
    VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
    info.stageCount = 2;
    info.pStages = stages;
    info.pVertexInputState = &input;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &area;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &samples;
    info.pDepthStencilState = &depth;
    info.pColorBlendState = &blend;
    info.layout = layout_;
    info.renderPass = pass_;
    require(vkCreateGraphicsPipelines(engine_.device, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline_));
    for (const VkShaderModule module : modules) vkDestroyShaderModule(engine_.device, module, nullptr);
  }

  const Engine& engine_;
  Buffer pixels_;
  Image colour_, depth_;
  VkRenderPass pass_{};
  VkFramebuffer framebuffer_{};
  VkPipelineLayout layout_{};
  VkPipeline pipeline_{};
};

inline void write_picture(const unsigned char* pixels, const std::string& path) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) throw std::runtime_error(path + " cannot be written");
  std::fprintf(file, "P6\n%u %u\n255\n", kSize, kSize);
  for (std::uint32_t k = 0; k < kSize * kSize; ++k) std::fwrite(pixels + std::size_t{4} * k, 1, 3, file);
  if (std::fclose(file) != 0) throw std::runtime_error(path + " could not be written to its end");
}
