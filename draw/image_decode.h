// Images of files, which nobody vouches for, as pixels.
#pragma once

#include <cstddef>
#include <span>

#include "draw/png.h"

namespace bodyopt::draw {

inline constexpr std::uint32_t kMostImagePixels = 8192;  // a side

// PNG, JPEG or WebP. Throws Error(file), whose text names no file, for other bytes, damaged or cut off, and for larger
// images.
Image decode_image(std::span<const std::byte> bytes);

}  // namespace bodyopt::draw
