// Pictures of parts of a skin, numbered: of the regions in which it is learned, and of places to look at.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "draw/png.h"
#include "draw/renderer.h"
#include "geometry/mesh.h"

namespace bodyopt::report {

struct DrawnRegion {
  std::span<const std::uint32_t> vertices;
  std::span<const double> weights;  // as many; of all regions together 1 at most at every vertex
};

// A colour for every region (linear RGB), none twice, those of regions that share vertices as different as may be.
std::vector<std::array<float, 3>> region_colours(std::span<const DrawnRegion> regions, std::size_t vertices);

constexpr std::array<std::array<float, 3>, 2> kFrontAndBack = {{{0, 0, 1}, {0, 0, -1}}};

// Front, left, back and right of a character that looks along +z.
constexpr std::array<std::array<float, 3>, 4> kAllAround = {{{0, 0, 1}, {1, 0, 0}, {0, 0, -1}, {-1, 0, 0}}};

struct RegionPicture {
  draw::Image image;
  std::vector<std::size_t>
      unnumbered;  // numbers (from 1) of regions too little of which is seen in any panel, ascending
};

// The skin (V x 3, T x 3) seen from these directions (towards the camera), a panel each, coloured by its regions. Each
// has its number (from 1) where it is seen; skin in no region is grey. Throws what Renderer::draw throws.
RegionPicture region_picture(draw::Renderer& renderer, std::span<const float> skin,
                             std::span<const std::uint32_t> triangles, std::span<const DrawnRegion> regions,
                             std::span<const std::array<float, 3>> colours, std::uint32_t panel_width,
                             std::uint32_t panel_height,
                             std::span<const std::array<float, 3>> directions = kFrontAndBack);

// White digits on a dark plate around the pixel (x, y), shifted as far as it takes to stay inside the picture.
void draw_number(draw::Image& image, int number, int x, int y);

using VertexList = std::vector<std::uint32_t>;

// Towards the camera: from the front (+z) and from every side (of the six along the axes) that most of a place faces.
std::vector<std::array<float, 3>> sides_of(const Positions& vertices, const Triangles& triangles,
                                           std::span<const VertexList> places);

// The skin (V x 3, rest space) from sides_of(), a panel each. Every place has its own colour and number (from 1). A
// vertex of several places has the first's, the rest of the skin is grey. Throws what Renderer::draw throws.
RegionPicture places_picture(draw::Renderer& renderer, const Positions& vertices, const Triangles& triangles,
                             std::span<const VertexList> places, std::uint32_t panel_width, std::uint32_t panel_height);

}  // namespace bodyopt::report
