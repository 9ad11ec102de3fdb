// Draws meshes offscreen with Vulkan: the pictures of reports, and the base of the viewport.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace bodyopt {

namespace vulkan {
class ValidationLog;
}

struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  // height x width x 4, sRGB, top row first
};

struct Camera {
  std::array<float, 3> eye{}, target{};  // metres, world
  float vertical_angle = 0.5f;           // radians
  float orthographic_height = 0;         // metres seen vertically, whatever the distance; 0: perspective
};

// A camera that sees all points (V x 3, world, at least one) as large as it can, from the direction given (world,
// towards the camera); aspect: width over height. Throws Error(usage).
Camera frame_points(std::span<const float> points, const std::array<float, 3>& direction, float aspect);

// The same for the corners of the box [low, high].
Camera frame_box(const std::array<float, 3>& low, const std::array<float, 3>& high,
                 const std::array<float, 3>& direction, float aspect);

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
  // Antialiased, clay under soft studio lights, on a dark neutral ground. Throws Error(usage) for a picture larger than
  // kMaxPictureSize a side, Error(mismatch) for meshes whose arrays do not fit each other or hold numbers that are not
  // finite, Error(device).
  Image draw(std::span<const DrawMesh> meshes, const Camera& camera, std::uint32_t width, std::uint32_t height);
  // What the validation layers said; outlives the renderer, to hear its teardown.
  std::shared_ptr<const vulkan::ValidationLog> validation_log() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Colour of a heat map for t in 0..1 (0: clay-neutral, 1: hot), linear RGB; perceptually ordered.
std::array<float, 3> heat_colour(float t);

std::vector<std::uint8_t> encode_png(const Image& image);
void write_png(const Image& image, const std::filesystem::path& path);  // throws Error(file)

}  // namespace bodyopt
