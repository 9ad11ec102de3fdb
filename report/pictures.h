// Pictures of one pose: the truth, the result, and where they differ.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "draw/cut_surface.h"
#include "draw/png.h"
#include "draw/renderer.h"
#include "geometry/mesh.h"
#include "runtime/core/transform.h"
#include "trainer/anatomy/anatomy_report.h"

namespace bodyopt::report {

// One pose, twice, or a third time by skinning that learns nothing. Pass welded vertices: normals are made from the
// triangles, and a seam would show as an edge.
struct PosePair {
  std::span<const std::uint32_t> triangles;  // T x 3
  std::span<const float> truth, result;      // V x 3, metres, posed
  std::span<const float> skinning = {};      // as many; empty: not to be shown
};

// How a skin is drawn; width and height in pixels.
struct Panel {
  draw::Camera camera;
  std::uint32_t width, height;
};

// A skin (V x 3, T x 3) in clay, or in these colours (V x 3, linear RGB). Throws what Renderer::draw throws.
draw::Image draw_skin(draw::Renderer& renderer, std::span<const std::uint32_t> triangles, std::span<const float> skin,
                      std::span<const float> colours, const Panel& panel);

// Pictures side by side, each panel_width x panel_height. Truth, skinning where it is given, and result are in clay.
// Last is the result coloured by its distance from the truth, heat_colour() from 0 to scale_mm (> 0). Throws
// Error(mismatch) when the arrays do not fit, and what Renderer::draw throws.
draw::Image comparison(draw::Renderer& renderer, const PosePair& pose, double scale_mm, const draw::Camera& camera,
                       std::uint32_t panel_width, std::uint32_t panel_height);

// The skin (V x 3, T x 3) from the front (+z) and from behind, side by side, 2 panel_width x panel_height. Each vertex
// has heat_colour() of its number from 0 to 1 (larger ones as 1). Throws what Renderer::draw throws.
draw::Image heat_on_skin(draw::Renderer& renderer, std::span<const float> skin,
                         std::span<const std::uint32_t> triangles, std::span<const double> heat,
                         std::uint32_t panel_width, std::uint32_t panel_height);

// The smallest scale that is not below `largest` and whose quarters are short numbers; 1 where nothing is above 0.
double heat_scale(double largest);

// A camera that sees both shapes whole, from a direction (world, towards the camera); aspect of one panel.
draw::Camera frame_pose(const PosePair& pose, const std::array<float, 3>& direction, float aspect);

// Triangles as the renderer takes them, T x 3.
inline std::span<const std::uint32_t> flat(const Triangles& triangles) {
  return {triangles.data(), static_cast<std::size_t>(triangles.size())};
}

// Frames points (N x 3) in a panel of so many pixels.
draw::Camera framed(std::span<const float> points, const std::array<float, 3>& direction, std::uint32_t width,
                    std::uint32_t height);

// The direction (world, towards the camera) that sees the vertex furthest from the truth: along its normal. It is zero
// where the triangles around it have no area.
std::array<float, 3> towards_worst(const PosePair& pose);

// V x 3: unit normals of a mesh (V x 3), each the direction of the summed areas around its vertex, or zero.
std::vector<float> smooth_normals(std::span<const std::uint32_t> triangles, std::span<const float> positions);

// Pictures of the same size, from left to right.
draw::Image side_by_side(std::span<const draw::Image> panels);

// A motion twice, frame by frame: the quasi-static skin and the same skin jiggling.
struct FlipBook {
  std::span<const std::uint32_t> triangles;             // T x 3
  std::span<const std::vector<float>> still, jiggling;  // per frame V x 3, world, metres
};

// A picture per frame: still on the left, jiggling on the right. Throws what Renderer::draw throws.
std::vector<draw::Image> flip_book_frames(draw::Renderer& renderer, const FlipBook& book, const Panel& panel);

// Chosen frames from left to right: still above, jiggling below, coloured by its distance from the still one,
// heat_colour() from 0 to scale_mm (> 0). Throws as above.
draw::Image flip_book_strip(draw::Renderer& renderer, const FlipBook& book, std::span<const std::size_t> frames,
                            double scale_mm, const Panel& panel);

// A pixel for each of the section, on a dark ground.
draw::Image section_image(const trainer::TissueSection& section, const trainer::TissueColours& colours);

// The picture of a section where the section is; rgba as of TissueColours.
draw::Soup standing_section(const trainer::SectionPlane& plane, std::span<const std::uint8_t> rgba);

// Pictures in rows of four, each in the middle of its place; numbered from 1 at the top left, so many of one number.
draw::Image numbered_sheet(std::span<const draw::Image> pictures, std::uint32_t of_one = 1);

// A picture of a character's muscles in its rest pose.

struct MuscleTube {
  std::vector<Vec3> path;  // metres, two points or more
  double radius;           // of the belly
};

// Muscles as tubes with the shape of their bellies, from the front (+z), from behind and from the left. Behind them is
// the half of the skin (V x 3, T x 3) that faces away. Throws what Renderer::draw throws.
draw::Image muscle_picture(draw::Renderer& renderer, std::span<const float> skin,
                           std::span<const std::uint32_t> triangles, std::span<const MuscleTube> muscles,
                           std::uint32_t panel_width, std::uint32_t panel_height);

}  // namespace bodyopt::report
