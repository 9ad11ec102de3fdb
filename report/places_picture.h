// A picture of the places of a skin where something is to be seen.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "draw/renderer.h"
#include "geometry/mesh.h"
#include "report/region_picture.h"

namespace bodyopt {

using VertexList = std::vector<std::uint32_t>;

// Towards the camera: from the front (+z) and from every side (of the six along the axes) that most of a place faces.
std::vector<std::array<float, 3>> sides_of(const Positions& vertices, const Triangles& triangles,
                                           std::span<const VertexList> places);

// The skin (V x 3, rest space) from sides_of(), a panel each: every place in a colour of its own with its number
// (from 1), a vertex of several with the first, the rest of the skin grey. Throws what Renderer::draw throws.
RegionPicture places_picture(Renderer& renderer, const Positions& vertices, const Triangles& triangles,
                             std::span<const VertexList> places, std::uint32_t panel_width, std::uint32_t panel_height);

}  // namespace bodyopt
