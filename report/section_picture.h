// Pictures of sections through a body's field of tissues.
#pragma once

#include <span>

#include "draw/cut_surface.h"
#include "draw/png.h"
#include "trainer/anatomy/tissue_colours.h"

namespace bodyopt {

// A pixel for each of the section, on a dark ground.
Image section_image(const TissueSection& section, const TissueColours& colours);

// The picture of a section where the section is; rgba as of TissueColours.
Soup standing_section(const SectionPlane& plane, std::span<const std::uint8_t> rgba);

// Pictures in rows of four, each in the middle of its place; numbered from 1 at the top left, so many of one number.
Image numbered_sheet(std::span<const Image> pictures, std::uint32_t of_one = 1);

}  // namespace bodyopt
