// Which pixels of a section are inside of a skin.
#pragma once

#include <vector>

#include "trainer/anatomy/section.h"

namespace bodyopt {

// width x height: where the crossings of the skin (V x 3, at rest or posed) along a row do not sum to none.
std::vector<bool> pixels_inside(const SectionPlane& plane, const Positions& skin, const Triangles& triangles);

// Of a plane through a body at rest: the pixels inside of its skin, where they are.
RestPoints rest_points(const SectionPlane& plane, const Positions& skin, const Triangles& triangles);

}  // namespace bodyopt
