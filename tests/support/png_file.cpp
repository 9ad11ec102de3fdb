#include "tests/support/png_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace bodyopt::testing {

draw::Image read_png(const std::filesystem::path& path) {
  int width = 0, height = 0, channels = 0;
  stbi_uc* pixels = stbi_load(path.c_str(), &width, &height, &channels, 4);
  if (!pixels) return {};
  draw::Image image{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
  image.rgba.assign(pixels, pixels + 4 * std::size_t{image.width} * image.height);
  stbi_image_free(pixels);
  return image;
}

SpotDifference spot_difference(const draw::Image& a, const draw::Image& b) {
  constexpr std::uint32_t kSpot = 10;
  if (a.width != b.width || a.height != b.height || a.rgba.empty()) return {};
  SpotDifference found{0, 0};
  int count = 0;
  for (std::uint32_t top = 0; top + kSpot <= a.height; top += kSpot) {
    for (std::uint32_t left = 0; left + kSpot <= a.width; left += kSpot) {
      for (std::size_t channel = 0; channel < 3; ++channel) {
        double difference = 0;
        for (std::uint32_t y = top; y < top + kSpot; ++y) {
          for (std::uint32_t x = left; x < left + kSpot; ++x) {
            const std::size_t at = 4 * (std::size_t{y} * a.width + x) + channel;
            difference += static_cast<double>(a.rgba[at]) - static_cast<double>(b.rgba[at]);
          }
        }
        difference = std::abs(difference) / (kSpot * kSpot);
        found.mean += difference;
        found.largest = std::max(found.largest, difference);
        ++count;
      }
    }
  }
  found.mean /= std::max(1, count);
  return found;
}

}  // namespace bodyopt::testing
