// Pictures in memory, and their files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace bodyopt::draw {

struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  // height x width x 4, sRGB, top row first
};

// Throws Error(usage) for an image without pixels, and one whose bytes are not those of its size.
std::vector<std::uint8_t> encode_png(const Image& image);
void write_png(const Image& image, const std::filesystem::path& path);  // throws Error(file)

}  // namespace bodyopt::draw
