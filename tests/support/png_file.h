// Reads PNG files, and compares pictures as eyes do: by large spots, not by single pixels.
#pragma once

#include <filesystem>

#include "draw/png.h"

namespace bodyopt::testing {

// Nothing where it cannot be read.
draw::Image read_png(const std::filesystem::path& path);

// How the colours of squares of 10 x 10 pixels differ, of 255. Edges that fall a pixel aside count little, a light that
// is out or a picture that is mirrored much.
struct SpotDifference {
  double mean = 255, largest = 255;
};
SpotDifference spot_difference(const draw::Image& a, const draw::Image& b);

}  // namespace bodyopt::testing
