// Pictures of meshes of the host, drawn as the viewport draws: for reports and verbs.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "draw/camera.h"
#include "draw/png.h"

namespace bodyopt::vulkan {
class ValidationLog;
}

namespace bodyopt::draw {

// A mesh to draw. Positions and normals V x 3, world; colours V x 3, linear RGB (empty: clay).
struct DrawMesh {
  std::span<const float> positions, normals;
  std::span<const std::uint32_t> triangles;
  std::span<const float> colours;
};

constexpr std::uint32_t kMaxPictureSize = 2048;  // pixels a side; drawn at twice that, which every device can

class Renderer {
 public:
  // `device` as in DeviceChoice (never "cpu": rendering needs a Vulkan device). Throws Error(device).
  explicit Renderer(const std::string& device = "auto", bool validation = false);
  ~Renderer();
  // Draws antialiased clay under soft studio lights, on a dark neutral ground. Throws Error(usage) for a picture larger
  // than kMaxPictureSize a side. Throws Error(mismatch) for meshes whose arrays do not fit each other or are not
  // finite, and Error(device).
  Image draw(std::span<const DrawMesh> meshes, const Camera& camera, std::uint32_t width, std::uint32_t height);
  // Returns the messages of the validation layers; it outlives the renderer, to hear its teardown.
  std::shared_ptr<const vulkan::ValidationLog> validation_log() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace bodyopt::draw
