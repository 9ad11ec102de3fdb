// Pictures of sections through a body's field of tissues.
#pragma once

#include <span>

#include "draw/png.h"
#include "trainer/anatomy/tissue_colours.h"

namespace bodyopt {

// A pixel for each of the section, on a dark ground.
Image section_image(const TissueSection& section, const TissueColours& colours);

// Pictures in rows of four, each in the middle of its place; numbered from 1 at the top left.
Image numbered_sheet(std::span<const Image> pictures);

}  // namespace bodyopt
