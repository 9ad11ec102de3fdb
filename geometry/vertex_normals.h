// Normals of a mesh's vertices.
#pragma once

#include "geometry/mesh.h"

namespace bodyopt {

// The sum of the normals of the triangles around each vertex, each twice its area long, V x 3; zero where there are
// none.
[[nodiscard]] Positions vertex_normals(const Positions& vertices, const Triangles& triangles);

}  // namespace bodyopt
