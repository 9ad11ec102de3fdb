#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
// The whole of stb's code is compiled here, under its own rules on warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

#include "draw/png.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 30;  // the encoder counts in int

}  // namespace

std::vector<std::uint8_t> encode_png(const Image& image) {
  const std::uint64_t bytes = std::uint64_t{image.width} * image.height * 4;
  if (bytes == 0 || bytes > kMaxBytes || image.rgba.size() != bytes) {
    throw Error(ErrorKind::usage, "an image of " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                                      " pixels with " + std::to_string(image.rgba.size()) + " bytes is no PNG");
  }
  std::vector<std::uint8_t> png;
  const auto append = [](void* to, void* data, int size) {
    const auto* const first = static_cast<const std::uint8_t*>(data);
    static_cast<std::vector<std::uint8_t>*>(to)->insert(static_cast<std::vector<std::uint8_t>*>(to)->end(), first,
                                                        first + size);
  };
  const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
  if (stbi_write_png_to_func(append, &png, width, height, 4, image.rgba.data(), 4 * width) == 0 || png.empty()) {
    throw Error(ErrorKind::file, "an image could not be encoded as PNG: out of memory");
  }
  return png;
}

void write_png(const Image& image, const std::filesystem::path& path) {
  const std::vector<std::uint8_t> png = encode_png(image);
  write_file_atomically(path, std::as_bytes(std::span(png)));
}

}  // namespace bodyopt
