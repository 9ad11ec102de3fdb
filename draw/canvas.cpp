#include "draw/canvas.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "draw/camera.h"
#include "draw/colours.h"
#include "draw/graphics_pipeline.h"
#include "draw/shadow_map.h"
#include "runtime/core/error.h"
#include "runtime/vulkan/commands.h"
#include "view_backdrop.frag.spv.h"
#include "view_blur.vert.spv.h"
#include "view_fibre.vert.spv.h"
#include "view_ground.frag.spv.h"
#include "view_ground.vert.spv.h"
#include "view_line.frag.spv.h"
#include "view_line.vert.spv.h"
#include "view_material.frag.spv.h"
#include "view_material.vert.spv.h"
#include "view_surface.frag.spv.h"
#include "view_surface.vert.spv.h"

namespace bodyopt::draw {

using vulkan::structure;

namespace {

constexpr std::uint32_t kPaletteSize = 256;

struct ViewPush {
  std::array<std::array<float, 4>, 3> rows;
  std::array<float, 4> projection;
};

struct SurfacePush {
  ViewPush view;
  std::array<float, 4> offset_alpha, tint_heat;
  std::uint32_t style, wire, orthographic, first_vertex, first_reference, reference_kind;
};
static_assert(sizeof(SurfacePush) == 120);

struct MaterialPush {
  ViewPush view;
  std::array<float, 4> colour;
  std::array<float, 3> offset;
  float least_alpha;
  std::uint32_t wire, orthographic, first_vertex;
};
static_assert(sizeof(MaterialPush) == 108);

struct GroundPush {
  ViewPush view;
  std::array<float, 4> shadow, ground;
  std::uint32_t grid, light, orthographic;
};
static_assert(sizeof(GroundPush) == 108);

struct BackdropPush {
  std::array<float, 2> scale;
  float opacity;
};

struct LinePush {
  ViewPush view;
  std::array<float, 4> offset;
  std::array<float, 2> half_width;
  std::uint32_t orthographic;
};
static_assert(sizeof(LinePush) == 92);

struct FibrePush {
  ViewPush view;
  std::array<float, 4> offset_lift;
  std::array<float, 2> half_width;
  std::uint32_t orthographic;
};
static_assert(sizeof(FibrePush) == 92);

// The reference of a surface holds one of these, numbered as in view_surface.vert and .frag.
enum ReferenceKind : std::uint32_t { kPositions, kDistances, kColours };

// The near and far planes enclose the view's sphere.
ViewPush view_push(const View& view) {
  ViewPush push;
  push.rows = view_matrix(view.camera);
  const auto& back = push.rows[2];
  const double z = -(static_cast<double>(back[0]) * view.middle[0] + static_cast<double>(back[1]) * view.middle[1] +
                     static_cast<double>(back[2]) * view.middle[2] + static_cast<double>(back[3]));
  push.projection = projection(view.camera, {z - view.radius, z + view.radius},
                               static_cast<double>(view.area.width) / view.area.height);
  return push;
}

// Shaders see what deformers and the host wrote before.
void await_data(VkCommandBuffer commands) {
  auto memory = structure<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
  memory.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
  memory.dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_INDEX_READ_BIT;
  vkCmdPipelineBarrier(
      commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
      VK_PIPELINE_STAGE_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_VERTEX_INPUT_BIT,
      0, 1, &memory, 0, nullptr, 0, nullptr);
}

VkRect2D inside(const Rectangle& part, VkExtent2D size) {
  const auto clamp = [](std::int64_t value, std::uint32_t limit) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(value, 0, limit));
  };
  const std::int32_t left = clamp(part.x, size.width), top = clamp(part.y, size.height);
  const std::int32_t right = clamp(std::int64_t{part.x} + part.width, size.width),
                     bottom = clamp(std::int64_t{part.y} + part.height, size.height);
  return {{left, top}, {static_cast<std::uint32_t>(right - left), static_cast<std::uint32_t>(bottom - top)}};
}

std::vector<float> palette_numbers() {
  std::vector<float> numbers;
  for (std::uint32_t k = 0; k < kPaletteSize; ++k) {
    const std::array<float, 3> colour = heat_colour(static_cast<float>(k) / (kPaletteSize - 1));
    numbers.insert(numbers.end(), colour.begin(), colour.end());
  }
  return numbers;
}

PipelineInfo line_info(std::span<const std::uint32_t> vertex, std::uint32_t buffers, std::uint32_t push_bytes,
                       VkSampleCountFlagBits samples, bool depth_test) {
  return {.vertex = vertex,
          .fragment = view_line_frag_spv,
          .storage_buffers = buffers,
          .push_bytes = push_bytes,
          .samples = samples,
          .blending = Blending::alpha,
          .depth_test = depth_test,
          .depth_write = false};
}

PipelineInfo surface_info(VkSampleCountFlagBits samples, bool ghost) {
  return {.vertex = view_surface_vert_spv,
          .fragment = view_surface_frag_spv,
          .storage_buffers = 5,
          .push_bytes = sizeof(SurfacePush),
          .samples = samples,
          .blending = ghost ? Blending::alpha : Blending::none,
          .depth_write = !ghost,
          .culls_back = ghost};
}

PipelineInfo material_info(VkSampleCountFlagBits samples, bool has_holes) {
  return {.vertex = view_material_vert_spv,
          .fragment = view_material_frag_spv,
          .storage_buffers = 4,
          .sampled_images = 2,
          .push_bytes = sizeof(MaterialPush),
          .samples = samples,
          .covers_by_alpha = has_holes};
}

constexpr VkImageLayout kColourLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
constexpr VkPipelineStageFlags kDrawing = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT |
                                          VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT |
                                          VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
constexpr VkAccessFlags kColourAccess = VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
constexpr VkAccessFlags kDepthAccess =
    VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;

// Clears, draws, and averages the samples where there are several; then the panels go on top.
RenderPass make_scene_pass(const vulkan::Device& device, VkSampleCountFlagBits samples) {
  const bool resolves = samples != VK_SAMPLE_COUNT_1_BIT;
  std::vector<PassAttachment> attachments = {
      {kColourFormat, VK_SAMPLE_COUNT_1_BIT, resolves ? VK_ATTACHMENT_LOAD_OP_DONT_CARE : VK_ATTACHMENT_LOAD_OP_CLEAR,
       VK_ATTACHMENT_STORE_OP_STORE, VK_IMAGE_LAYOUT_UNDEFINED, kColourLayout},
      {kDepthFormat, samples, VK_ATTACHMENT_LOAD_OP_CLEAR, VK_ATTACHMENT_STORE_OP_DONT_CARE, VK_IMAGE_LAYOUT_UNDEFINED,
       VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL}};
  if (resolves) {
    attachments.push_back({kColourFormat, samples, VK_ATTACHMENT_LOAD_OP_CLEAR, VK_ATTACHMENT_STORE_OP_DONT_CARE,
                           VK_IMAGE_LAYOUT_UNDEFINED, kColourLayout});
  }
  const VkAttachmentReference picture{0, kColourLayout}, several{2, kColourLayout};
  const VkAttachmentReference depth{1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = resolves ? &several : &picture;
  subpass.pResolveAttachments = resolves ? &picture : nullptr;
  subpass.pDepthStencilAttachment = &depth;

  const std::array dependencies = {
      // The picture before may still be on its way out.
      VkSubpassDependency{VK_SUBPASS_EXTERNAL, 0, kDrawing | VK_PIPELINE_STAGE_TRANSFER_BIT, kDrawing,
                          VK_ACCESS_TRANSFER_READ_BIT | kColourAccess | kDepthAccess, kColourAccess | kDepthAccess, 0},
      VkSubpassDependency{0, VK_SUBPASS_EXTERNAL, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                          VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT, VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                          kColourAccess, 0}};
  return make_render_pass(device, attachments, subpass, dependencies);
}

RenderPass make_panel_pass(const vulkan::Device& device) {
  const std::array dependencies = {
      VkSubpassDependency{VK_SUBPASS_EXTERNAL, 0, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                          VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT, VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                          kColourAccess, 0},
      VkSubpassDependency{0, VK_SUBPASS_EXTERNAL, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                          VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                          VK_ACCESS_TRANSFER_READ_BIT, 0}};
  return make_colour_pass(device,
                          {kPictureFormat, VK_SAMPLE_COUNT_1_BIT, VK_ATTACHMENT_LOAD_OP_LOAD,
                           VK_ATTACHMENT_STORE_OP_STORE, kColourLayout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL},
                          dependencies);
}

}  // namespace

// The images that are drawn into.
class CanvasImages {
 public:
  CanvasImages(const vulkan::Device& device, VkRenderPass scene_pass, VkRenderPass panel_pass, VkExtent2D size,
               VkSampleCountFlagBits samples)
      : size_(size),
        depth_(make_attachment(
            device, {size, kDepthFormat, samples,
                     VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT})),
        picture_(make_attachment(
            device, {size, kColourFormat, VK_SAMPLE_COUNT_1_BIT,
                     VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT, kPictureFormat})),
        bytes_(make_view(device, picture_.image.get(), kPictureFormat)),
        panels_(make_framebuffer(device, panel_pass, size, {bytes_.get()})) {
    if (samples == VK_SAMPLE_COUNT_1_BIT) {
      scene_ = make_framebuffer(device, scene_pass, size, {picture_.view.get(), depth_.view.get()});
      return;
    }
    colour_ = make_attachment(device, {size, kColourFormat, samples,
                                       VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT});
    scene_ = make_framebuffer(device, scene_pass, size, {picture_.view.get(), depth_.view.get(), colour_.view.get()});
  }

  VkExtent2D size() const { return size_; }
  VkImage image() const { return picture_.image.get(); }
  VkFramebuffer scene() const { return scene_.get(); }
  VkFramebuffer panels() const { return panels_.get(); }

 private:
  VkExtent2D size_;
  Attachment colour_, depth_;  // of several samples; no colour of one
  Attachment picture_;         // linear colours go in by its view, the panels' bytes by the other
  ImageView bytes_;
  Framebuffer scene_, panels_;
};

struct Canvas::Impl {
  // Draws the scene with so many samples a pixel. Canvases of a device share them.
  struct ScenePipelines {
    ScenePipelines(const vulkan::Device& device, VkSampleCountFlagBits samples_)
        : samples(samples_),
          pass(make_scene_pass(device, samples)),
          ground(device, pass.get(),
                 {.vertex = view_ground_vert_spv,
                  .fragment = view_ground_frag_spv,
                  .sampled_images = 1,
                  .push_bytes = sizeof(GroundPush),
                  .samples = samples,
                  .depth_test = false,
                  .depth_write = false}),
          backdrop(device, pass.get(),
                   {.vertex = view_blur_vert_spv,
                    .fragment = view_backdrop_frag_spv,
                    .sampled_images = 1,
                    .push_bytes = sizeof(BackdropPush),
                    .samples = samples,
                    .blending = Blending::alpha,
                    .depth_test = false,
                    .depth_write = false}),
          surface(device, pass.get(), surface_info(samples, false)),
          ghost(device, pass.get(), surface_info(samples, true)),
          material(device, pass.get(), material_info(samples, false)),
          holed(device, pass.get(), material_info(samples, true)),
          line(device, pass.get(), line_info(view_line_vert_spv, 1, sizeof(LinePush), samples, true)),
          line_on_top(device, pass.get(), line_info(view_line_vert_spv, 1, sizeof(LinePush), samples, false)),
          fibre(device, pass.get(), line_info(view_fibre_vert_spv, 5, sizeof(FibrePush), samples, true)) {}

    VkSampleCountFlagBits samples;
    RenderPass pass;
    GraphicsPipeline ground, backdrop, surface, ghost, material, holed, line, line_on_top, fibre;
  };
  struct SmoothPipelines : ScenePipelines {
    explicit SmoothPipelines(const vulkan::Device& device) : ScenePipelines(device, kSamples) {}
  };
  struct QuickPipelines : ScenePipelines {
    explicit QuickPipelines(const vulkan::Device& device) : ScenePipelines(device, VK_SAMPLE_COUNT_1_BIT) {}
  };

  explicit Impl(const vulkan::Device& d)
      : device(d),
        panel_pass(make_panel_pass(device)),
        sets(device),
        palette(vulkan::upload(device, palette_numbers(), "the colour bar")),
        commands(device) {}

  // A copy of host data that lives until the next picture.
  template <typename T>
  const vulkan::Buffer& stream(std::span<const T> values) {
    streamed.push_back(std::make_unique<vulkan::Buffer>(device, values.size_bytes(), vulkan::Memory::staging, "lines"));
    if (!values.empty()) std::memcpy(streamed.back()->mapped(), values.data(), values.size_bytes());
    return *streamed.back();
  }

  void record_ground(VkCommandBuffer recorder, const View& view, const ViewPush& push, const ShadowMap& shadow) {
    const Ground& g = view.ground;
    scene->ground.bind(recorder);
    scene->ground.draw(recorder, sets.make(scene->ground, {}, {shadow.image()}),
                       GroundPush{push,
                                  {view.middle[0], view.middle[2], shadow_scale(view), g.shadow},
                                  {g.height, g.spacing, g.reach * view.radius, g.axes ? 1.0f : 0.0f},
                                  g.grid,
                                  g.light,
                                  view.camera.orthographic_height > 0},
                       3);
  }

  void record_backdrop(VkCommandBuffer recorder, const Backdrop& backdrop, const Rectangle& area) {
    const float wider = static_cast<float>(area.width) / static_cast<float>(area.height) / backdrop.aspect;
    scene->backdrop.bind(recorder);
    scene->backdrop.draw(recorder, sets.make(scene->backdrop, {}, {backdrop.image}),
                         BackdropPush{{std::max(1.0f, wider), std::max(1.0f, 1 / wider)}, backdrop.opacity}, 3);
  }

  void record_materials(VkCommandBuffer recorder, const SkinDraw& skin, const ViewPush& push, bool orthographic) {
    const SurfaceDraw& own = *skin.materials;
    for (const SurfacePart& part : own.parts) {
      const GraphicsPipeline& pipeline = part.least_alpha ? scene->holed : scene->material;
      pipeline.bind(recorder);
      pipeline.draw(
          recorder,
          sets.make(pipeline, {&own.corners, skin.positions, skin.normals, &own.vertices}, {part.image, part.detail}),
          MaterialPush{push, part.colour, skin.offset, part.least_alpha.value_or(-1), skin.wire, orthographic,
                       skin.first_vertex},
          part.corner_count, skin.wire ? nullptr : &own.corners, part.first_corner);
    }
  }

  void record_skin(VkCommandBuffer recorder, const SkinDraw& skin, const ViewPush& push, bool orthographic) {
    const ReferenceKind kind = skin.colours ? kColours : skin.distances ? kDistances : kPositions;
    const vulkan::Buffer* heat = skin.colours ? skin.colours : skin.distances ? skin.distances : skin.reference;
    if (skin.materials && !skin.materials->parts.empty() && skin.style == SurfaceStyle::material && !heat &&
        skin.alpha >= 1) {
      return record_materials(recorder, skin, push, orthographic);
    }
    const GraphicsPipeline& pipeline = skin.alpha < 1 ? scene->ghost : scene->surface;
    pipeline.bind(recorder);
    const VkDescriptorSet set =
        sets.make(pipeline, {skin.triangles, skin.positions, skin.normals, heat ? heat : skin.positions, &palette});
    pipeline.draw(
        recorder, set,
        SurfacePush{push,
                    {skin.offset[0], skin.offset[1], skin.offset[2], skin.alpha},
                    {skin.colour[0], skin.colour[1], skin.colour[2], heat ? 1 / std::max(1e-6f, skin.heat_range) : 0},
                    static_cast<std::uint32_t>(skin.style),
                    skin.wire,
                    orthographic,
                    skin.first_vertex,
                    skin.first_reference,
                    kind},
        3 * skin.triangle_count, skin.wire ? nullptr : skin.triangles);
  }

  void record_lines(VkCommandBuffer recorder, const LineDraw& lines, const ViewPush& push, const View& view) {
    if (lines.points.empty()) return;
    const GraphicsPipeline& pipeline = lines.on_top ? scene->line_on_top : scene->line;
    pipeline.bind(recorder);
    pipeline.draw(recorder, sets.make(pipeline, {&stream(lines.points)}),
                  LinePush{push,
                           {lines.offset[0], lines.offset[1], lines.offset[2], 0},
                           half_width(lines.width, view),
                           view.camera.orthographic_height > 0},
                  static_cast<std::uint32_t>(3 * lines.points.size()));
  }

  void record_fibres(VkCommandBuffer recorder, const FibreDraw& fibres, const ViewPush& push, const View& view) {
    if (fibres.segment_count == 0) return;
    scene->fibre.bind(recorder);
    const VkDescriptorSet set = sets.make(
        scene->fibre, {fibres.segments, fibres.points, fibres.positions, fibres.normals, &stream(fibres.colours)});
    scene->fibre.draw(recorder, set,
                      FibrePush{push,
                                {fibres.offset[0], fibres.offset[1], fibres.offset[2], fibres.lift},
                                half_width(fibres.width, view),
                                view.camera.orthographic_height > 0},
                      6 * fibres.segment_count);
  }

  static std::array<float, 2> half_width(float width, const View& view) {
    return {width / static_cast<float>(view.area.width), width / static_cast<float>(view.area.height)};
  }

  void record_view(VkCommandBuffer recorder, const View& view, const ViewPush& push, const ShadowMap& shadow) {
    const VkRect2D part = inside(view.part, picture->size());
    if (part.extent.width == 0 || part.extent.height == 0) return;
    const VkViewport area{static_cast<float>(view.area.x),
                          static_cast<float>(view.area.y),
                          static_cast<float>(view.area.width),
                          static_cast<float>(view.area.height),
                          0,
                          1};
    vkCmdSetViewport(recorder, 0, 1, &area);
    vkCmdSetScissor(recorder, 0, 1, &part);
    record_ground(recorder, view, push, shadow);
    if (view.backdrop) record_backdrop(recorder, *view.backdrop, view.area);
    for (const SkinDraw& skin : view.skins) {
      record_skin(recorder, skin, push, view.camera.orthographic_height > 0);
    }
    for (const FibreDraw& fibres : view.fibres) record_fibres(recorder, fibres, push, view);
    for (const LineDraw& lines : view.lines) record_lines(recorder, lines, push, view);
  }

  void prepare(VkExtent2D size, Edges edges) {
    const ScenePipelines& wanted = edges == Edges::smooth
                                       ? static_cast<const ScenePipelines&>(device.shared<SmoothPipelines>())
                                       : device.shared<QuickPipelines>();
    const bool fits =
        picture && scene == &wanted && picture->size().width == size.width && picture->size().height == size.height;
    scene = &wanted;
    if (fits) return;
    picture.reset();
    picture.emplace(device, scene->pass.get(), panel_pass.get(), size, scene->samples);
  }

  const vulkan::Device& device;
  RenderPass panel_pass;
  PictureSets sets;
  const ScenePipelines* scene = nullptr;  // of this picture
  vulkan::Buffer palette;
  vulkan::Commands commands;
  std::vector<std::unique_ptr<ShadowMap>> shadows;  // of the views
  std::vector<std::unique_ptr<vulkan::Buffer>> streamed;
  std::optional<CanvasImages> picture;
};

Canvas::Canvas(const vulkan::Device& device) : impl_(std::make_unique<Impl>(device)) {}

Canvas::~Canvas() = default;

VkRenderPass Canvas::panel_pass() const { return impl_->panel_pass.get(); }
std::uint32_t Canvas::most_pixels() const {
  VkPhysicalDeviceProperties properties{};
  vkGetPhysicalDeviceProperties(impl_->device.physical(), &properties);
  return std::min(kMostCanvasPixels, properties.limits.maxImageDimension2D);
}

VkImage Canvas::image() const { return impl_->picture->image(); }
VkExtent2D Canvas::size() const { return impl_->picture->size(); }

void Canvas::draw(std::span<const View> views, std::uint32_t width, std::uint32_t height, Edges edges,
                  const std::function<void(VkCommandBuffer)>& panels) {
  const std::uint32_t most = most_pixels();
  if (width == 0 || height == 0 || width > most || height > most) {
    throw Error(ErrorKind::usage, "a picture has 1 to " + std::to_string(most) + " pixels a side, not " +
                                      std::to_string(width) + " x " + std::to_string(height));
  }
  std::vector<ViewPush> pushes;  // before anything is recorded: they refuse cameras
  for (const View& view : views) pushes.push_back(view_push(view));
  Impl& v = *impl_;
  v.prepare({width, height}, edges);
  v.streamed.clear();
  v.sets.reset();
  while (v.shadows.size() < views.size()) v.shadows.push_back(std::make_unique<ShadowMap>(v.device));
  v.commands.begin();
  const VkCommandBuffer recorder = v.commands.handle();
  v.commands.timestamp();
  await_data(recorder);
  for (std::size_t k = 0; k < views.size(); ++k) v.shadows[k]->record(recorder, v.sets, views[k]);
  begin_pass(recorder, v.scene->pass.get(), v.picture->scene(), v.picture->size());
  for (std::size_t k = 0; k < views.size(); ++k) v.record_view(recorder, views[k], pushes[k], *v.shadows[k]);
  vkCmdEndRenderPass(recorder);
  begin_pass(recorder, v.panel_pass.get(), v.picture->panels(), v.picture->size());
  if (panels) panels(recorder);
  vkCmdEndRenderPass(recorder);
  v.commands.timestamp();
  v.commands.end();
  v.commands.run();
}

double Canvas::seconds() const {
  const std::vector<double> seconds = impl_->commands.seconds();
  return seconds.empty() ? 0 : seconds[0];
}

Image Canvas::picture() const {
  const VkExtent2D size = this->size();
  const VkDeviceSize bytes = VkDeviceSize{size.width} * size.height * 4;
  const vulkan::Buffer readback(impl_->device, bytes, vulkan::Memory::staging, "the picture");
  vulkan::Commands commands(impl_->device);
  commands.begin();
  VkBufferImageCopy region{};
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  region.imageExtent = {size.width, size.height, 1};
  vkCmdCopyImageToBuffer(commands.handle(), image(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, readback.handle(), 1,
                         &region);
  commands.end();
  commands.run();
  Image image{size.width, size.height, std::vector<std::uint8_t>(bytes)};
  std::memcpy(image.rgba.data(), readback.mapped(), bytes);
  return image;
}

}  // namespace bodyopt::draw
