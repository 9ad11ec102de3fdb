// What the viewport draws: views of skins that are on the device, lines, the ground.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "draw/graphics_pipeline.h"
#include "draw/renderer.h"
#include "runtime/vulkan/buffer.h"

namespace bodyopt::draw {

// material: as its materials say; clay where it has none.
enum class SurfaceStyle : std::uint32_t { clay, material, matcap, flat, normals, silhouette };

constexpr std::array<float, 3> kClayColour = {0.545f, 0.500f, 0.440f};  // linear RGB, as in studio.glsl

struct SurfaceVertex {
  std::uint32_t vertex;           // of positions and normals
  float u, v;                     // in the image
  std::uint32_t red_green, blue;  // of its own, 16 bits each, linear
};

// The triangles of a material.
struct SurfacePart {
  std::uint32_t first_corner, corner_count;
  std::array<float, 4> colour;  // linear RGB and alpha, times the image's
  SampledImage image;
  SampledImage detail;  // red, green: the normal's; blue: how rough it is; times what its material says
  // There is a hole where its alpha is lower; 0: it is as see-through as its alpha says; none: opaque.
  std::optional<float> least_alpha;
};

struct SurfaceDraw {
  vulkan::Buffer corners;   // into vertices, part by part
  vulkan::Buffer vertices;  // SurfaceVertex
  std::vector<SurfacePart> parts;
};

// One frame of a skin. Its buffers must live until the picture is drawn.
struct SkinDraw {
  const vulkan::Buffer* triangles = nullptr;  // T x 3
  std::uint32_t triangle_count = 0;
  const vulkan::Buffer* positions = nullptr;  // F x V x 3, metres, world
  const vulkan::Buffer* normals = nullptr;    // F x V x 3
  std::uint32_t first_vertex = 0;             // of the frame to draw: number of the frame x V
  std::array<float, 3> offset{};              // world, metres
  SurfaceStyle style = SurfaceStyle::clay;
  std::array<float, 3> colour = kClayColour;
  const SurfaceDraw* materials = nullptr;  // or null: none
  bool wire = false;
  bool shadow = true;
  float alpha = 1;  // below 1: a ghost
  // Coloured by the distance to these positions, F' x V x 3, or by these distances, F' x V, metres; red at `heat_range`
  // metres. Or by these colours, F' x V x 3, linear RGB. Null: not.
  const vulkan::Buffer *reference = nullptr, *distances = nullptr, *colours = nullptr;
  std::uint32_t first_reference = 0;
  float heat_range = 0.005f;
};

struct LinePoint {
  float x, y, z;         // metres, world
  std::uint32_t colour;  // sRGB and alpha, red in the lowest byte
};

struct LineDraw {
  std::span<const LinePoint> points;  // two per line
  std::array<float, 3> offset{};
  float width = 1.5f;   // pixels
  bool on_top = false;  // seen through skins
};

struct FibreSegment {
  std::uint32_t from, to, fibre;
};

// Fibres on a skin. Buffers as those of SkinDraw.
struct FibreDraw {
  const vulkan::Buffer* segments = nullptr;  // FibreSegment
  std::uint32_t segment_count = 0;
  const vulkan::Buffer* points = nullptr;  // FibrePoint, of runtime vertices
  const vulkan::Buffer *positions = nullptr, *normals = nullptr;
  std::span<const std::uint32_t> colours;  // per fibre, as LinePoint::colour
  std::array<float, 3> offset{};
  float lift = 0.002f;  // metres above the skin
  float width = 2;      // pixels
};

struct Rectangle {
  std::int32_t x = 0, y = 0;  // pixels, from the top left
  std::uint32_t width = 0, height = 0;
};

struct Ground {
  bool grid = true, axes = false;
  bool light = false;                // nothing but a light backdrop
  float height = 0, spacing = 0.1f;  // metres
  float shadow = 0.75f;              // strength; 0: none
  float caster = 0;    // radius of the smallest of those that cast it, metres: how soft it is; 0: the view's
  float reach = 2.5f;  // of the light that falls on it, in radii of the view; 0: there is no ground
};

constexpr Ground kNoGround{.grid = false, .shadow = 0, .reach = 0};

// An image behind the characters and over the ground, as large as fits into the view. It must live until the picture is
// drawn.
struct Backdrop {
  SampledImage image;
  float aspect = 1;  // width over height
  float opacity = 1;
};

// A part of the picture.
struct View {
  Camera camera;
  Rectangle area;  // that the camera fills
  Rectangle part;  // of it that is drawn: a wipe draws two views into one area
  std::array<float, 3> middle{};
  float radius = 1;  // all that is drawn lies in this sphere, world, metres
  Ground ground;
  std::optional<Backdrop> backdrop{};
  std::vector<SkinDraw> skins;  // ghosts last
  std::vector<LineDraw> lines;
  std::vector<FibreDraw> fibres;
};

}  // namespace bodyopt::draw
