// Triangles that all wind the same way.
#pragma once

#include "geometry/mesh.h"

namespace bodyopt {

// Turns triangles until any two that alone share an edge run through it in opposite directions, of every part of the
// surface that such edges join the fewer. Returns how many were turned. What is one-sided (a Moebius strip) keeps edges
// that are run through twice in one direction.
Eigen::Index wind_alike(Triangles& triangles);

}  // namespace bodyopt
