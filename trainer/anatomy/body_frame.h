// Which way a body stands and looks in its file.
#pragma once

#include <Eigen/Core>

#include "assets/character.h"

namespace bodyopt {

class NearestSkin;

// How far on average the vertices (V x 3, one at least) lie from their skin, mirrored across an axis at `middle`;
// metres.
double mirror_error(const Positions& vertices, const NearestSkin& skin, int axis, double middle);

// A turn between coordinate axes, from rest space to one in which the body stands y up, with its left at +x, so that it
// looks along z: up as the file's nodes have it (turn_upright), left by the joints that are named so; where none are,
// the axis about which the skin is its own mirror image more closely.
Eigen::Matrix3d body_frame(const Character& character);

// The same character, its skin and joints turned by a rotation.
Character turned(const Character& character, const Eigen::Matrix3d& rotation);

}  // namespace bodyopt
