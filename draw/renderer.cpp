#include "draw/renderer.h"

#include <algorithm>
#include <cmath>

#include "draw/camera.h"
#include "draw/graphics_pipeline.h"
#include "draw/target.h"
#include "draw_surface.frag.spv.h"
#include "draw_surface.vert.spv.h"
#include "runtime/core/error.h"
#include "runtime/vulkan/commands.h"

namespace bodyopt {
namespace {

enum class SurfaceKind : std::uint32_t { clay = 0, coloured = 1, backdrop = 2 };

// That of draw_surface.
struct SurfacePush {
  std::array<std::array<float, 4>, 3> view;
  std::array<float, 4> projection;
  SurfaceKind kind;
  std::uint32_t orthographic;
};
static_assert(sizeof(SurfacePush) == 72);

[[noreturn]] void refuse_mesh(std::size_t index, const std::string& what) {
  throw Error(ErrorKind::mismatch, "mesh " + std::to_string(index) + " to draw: " + what);
}

// Throws unless the shader can read this mesh without leaving a buffer or making a NaN.
void check_mesh(const DrawMesh& mesh, std::size_t index) {
  const std::size_t values = mesh.positions.size();
  if (values % 3 != 0 || mesh.normals.size() != values || (!mesh.colours.empty() && mesh.colours.size() != values)) {
    refuse_mesh(index, "positions, normals and colours hold " + std::to_string(values) + ", " +
                           std::to_string(mesh.normals.size()) + " and " + std::to_string(mesh.colours.size()) +
                           " numbers; expected three per vertex of each (or no colours)");
  }
  if (mesh.triangles.size() % 3 != 0) refuse_mesh(index, "the triangles' corners are not a multiple of three");
  for (const std::uint32_t vertex : mesh.triangles) {
    if (vertex >= values / 3) {
      refuse_mesh(index, "a triangle names vertex " + std::to_string(vertex) + " of " + std::to_string(values / 3));
    }
  }
  for (const std::span<const float> numbers : {mesh.positions, mesh.normals, mesh.colours}) {
    if (!std::all_of(numbers.begin(), numbers.end(), [](float x) { return std::abs(x) <= kMaxCoordinate; })) {
      refuse_mesh(index, "positions, normals or colours are not finite, or beyond 1e9");
    }
  }
}

DepthRange depth_range(std::span<const DrawMesh> meshes, const std::array<float, 4>& back) {
  DepthRange range;
  for (const DrawMesh& mesh : meshes) {
    for (std::size_t i = 0; i < mesh.positions.size(); i += 3) {
      const double z =
          back[0] * mesh.positions[i] + back[1] * mesh.positions[i + 1] + back[2] * mesh.positions[i + 2] + back[3];
      range.nearest = std::min(range.nearest, -z);
      range.farthest = std::max(range.farthest, -z);
    }
  }
  return range;
}

// What the host wrote before is seen by the vertex shader.
void await_uploads(VkCommandBuffer commands) {
  auto memory = vulkan::structure<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
  memory.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
  memory.dstAccessMask = VK_ACCESS_SHADER_READ_BIT;
  vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_VERTEX_SHADER_BIT, 0, 1, &memory, 0,
                       nullptr, 0, nullptr);
}

struct MeshBuffers {
  vulkan::Buffer triangles, positions, normals, colours;
  VkDescriptorSet set = VK_NULL_HANDLE;
};

}  // namespace

struct Renderer::Impl {
  explicit Impl(const DeviceChoice& choice)
      : device(choice, {.draws = true}),
        render_pass(make_target_pass(device)),
        pipeline(device, render_pass.get(),
                 {.vertex = draw_surface_vert_spv,
                  .fragment = draw_surface_frag_spv,
                  .storage_buffers = 4,
                  .push_bytes = sizeof(SurfacePush)}) {}

  MeshBuffers upload(const DrawMesh& mesh, PictureSets& sets) const {
    MeshBuffers buffers;
    buffers.triangles = vulkan::upload_bytes(device, std::as_bytes(mesh.triangles), "triangles");
    buffers.positions = vulkan::upload_bytes(device, std::as_bytes(mesh.positions), "positions");
    buffers.normals = vulkan::upload_bytes(device, std::as_bytes(mesh.normals), "normals");
    buffers.colours = vulkan::upload_bytes(device, std::as_bytes(mesh.colours), "colours");
    buffers.set = sets.make(pipeline, {&buffers.triangles, &buffers.positions, &buffers.normals, &buffers.colours});
    return buffers;
  }

  vulkan::Device device;
  RenderPass render_pass;
  GraphicsPipeline pipeline;
};

Renderer::Renderer(const std::string& device, bool validation)
    : impl_(std::make_unique<Impl>(DeviceChoice{.name = device, .validation = validation})) {}

Renderer::~Renderer() = default;

std::shared_ptr<const vulkan::ValidationLog> Renderer::validation_log() const { return impl_->device.validation_log(); }

Image Renderer::draw(std::span<const DrawMesh> meshes, const Camera& camera, std::uint32_t width,
                     std::uint32_t height) {
  if (width == 0 || height == 0 || width > kMaxPictureSize || height > kMaxPictureSize) {
    throw Error(ErrorKind::usage, "a picture has 1 to " + std::to_string(kMaxPictureSize) + " pixels a side, not " +
                                      std::to_string(width) + " x " + std::to_string(height));
  }
  for (std::size_t m = 0; m < meshes.size(); ++m) check_mesh(meshes[m], m);
  SurfacePush push;
  push.view = view_matrix(camera);
  push.orthographic = camera.orthographic_height > 0;
  push.projection = projection(camera, depth_range(meshes, push.view[2]), static_cast<double>(width) / height);

  const vulkan::Device& device = impl_->device;
  const GraphicsPipeline& pipeline = impl_->pipeline;
  PictureSets sets(device);
  const MeshBuffers nothing = impl_->upload({}, sets);
  std::vector<MeshBuffers> buffers;
  for (const DrawMesh& mesh : meshes) buffers.push_back(impl_->upload(mesh, sets));
  const Target target(device, impl_->render_pass.get(), width, height);

  vulkan::Commands commands(device);
  commands.begin();
  const VkCommandBuffer recorder = commands.handle();
  await_uploads(recorder);
  target.begin(recorder);
  pipeline.bind(recorder);
  push.kind = SurfaceKind::backdrop;
  pipeline.draw(recorder, nothing.set, push, 3);
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    push.kind = meshes[m].colours.empty() ? SurfaceKind::clay : SurfaceKind::coloured;
    pipeline.draw(recorder, buffers[m].set, push, static_cast<std::uint32_t>(meshes[m].triangles.size()));
  }
  target.end(recorder);
  commands.end();
  commands.run();
  return target.picture();
}

}  // namespace bodyopt
