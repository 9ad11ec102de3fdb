// How thick a body is behind its skin.
#pragma once

#include "trainer/dataset/character.h"

namespace bodyopt {

// Per vertex, metres: along its normal to the skin behind it, averaged over the skin nearby (the shape diameter:
// Shapira, Shamir, Cohen-Or 2008, with one ray), between a 180th and a sixth of the body's extent.
Eigen::VectorXd thickness(const Positions& vertices, const Triangles& triangles);

// Area-weighted unit normals, V x 3; zero where there is no area.
Positions vertex_normals(const Positions& vertices, const Triangles& triangles);

}  // namespace bodyopt
