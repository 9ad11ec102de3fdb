#include "draw/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "draw/canvas.h"
#include "draw/colours.h"
#include "runtime/core/error.h"
#include "runtime/host/device_choice.h"

namespace bodyopt::draw {
namespace {

constexpr std::uint32_t kOversampling = 2;  // a side, on top of the samples

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

// The middle of the box around the meshes, and how far its corners are from there.
void enclose(std::span<const DrawMesh> meshes, View& view) {
  std::array<float, 3> low, high;
  low.fill(kMaxCoordinate);
  high.fill(-kMaxCoordinate);
  for (const DrawMesh& mesh : meshes) {
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      low[i % 3] = std::min(low[i % 3], mesh.positions[i]);
      high[i % 3] = std::max(high[i % 3], mesh.positions[i]);
    }
  }
  if (low[0] > high[0]) return;
  for (std::size_t i = 0; i < 3; ++i) view.middle[i] = 0.5f * (low[i] + high[i]);
  view.radius = 0.5f * std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
}

// A table holds the light of every byte, as a picture has millions of pixels.
std::array<float, 256> make_lights() {
  std::array<float, 256> lights;
  for (std::size_t k = 0; k < lights.size(); ++k) lights[k] = linear(static_cast<std::uint8_t>(k));
  return lights;
}

// Every pixel is the mean light of kOversampling x kOversampling.
Image shrunk(const Image& drawn) {
  static const std::array<float, 256> lights = make_lights();
  Image image{drawn.width / kOversampling, drawn.height / kOversampling, {}};
  image.rgba.reserve(std::size_t{image.width} * image.height * 4);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      std::array<float, 3> light{};
      for (std::uint32_t k = 0; k < kOversampling * kOversampling; ++k) {
        const std::size_t row = kOversampling * y + k / kOversampling, column = kOversampling * x + k % kOversampling;
        for (std::size_t c = 0; c < 3; ++c) light[c] += lights[drawn.rgba[4 * (row * drawn.width + column) + c]];
      }
      for (float& l : light) l /= kOversampling * kOversampling;
      const std::array<std::uint8_t, 3> colour = srgb(light);
      image.rgba.insert(image.rgba.end(), {colour[0], colour[1], colour[2], 255});
    }
  }
  return image;
}

struct MeshBuffers {
  vulkan::Buffer triangles, positions, normals, colours;
};

MeshBuffers upload(vulkan::Uploads& uploads, const DrawMesh& mesh) {
  return {uploads.add(std::as_bytes(mesh.triangles), "triangles"),
          uploads.add(std::as_bytes(mesh.positions), "positions"), uploads.add(std::as_bytes(mesh.normals), "normals"),
          uploads.add(std::as_bytes(mesh.colours), "colours")};
}

SkinDraw drawn(const MeshBuffers& buffers, const DrawMesh& mesh) {
  SkinDraw skin;
  skin.triangles = &buffers.triangles;
  skin.triangle_count = static_cast<std::uint32_t>(mesh.triangles.size() / 3);
  skin.positions = &buffers.positions;
  skin.normals = &buffers.normals;
  skin.colours = mesh.colours.empty() ? nullptr : &buffers.colours;
  return skin;
}

}  // namespace

struct Renderer::Impl {
  explicit Impl(const DeviceChoice& choice) : device(choice, {.draws = true}), canvas(device) {}

  vulkan::Device device;
  Canvas canvas;
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
  const Rectangle whole{0, 0, kOversampling * width, kOversampling * height};
  View view;
  view.camera = camera;
  view.area = view.part = whole;
  view.ground = kNoGround;
  enclose(meshes, view);
  std::vector<MeshBuffers> buffers;
  buffers.reserve(meshes.size());
  vulkan::Uploads uploads(impl_->device);
  for (const DrawMesh& mesh : meshes) {
    buffers.push_back(upload(uploads, mesh));
    view.skins.push_back(drawn(buffers.back(), mesh));
  }
  uploads.finish();
  impl_->canvas.draw({&view, 1}, whole.width, whole.height, Edges::smooth);
  return shrunk(impl_->canvas.picture());
}

}  // namespace bodyopt::draw
