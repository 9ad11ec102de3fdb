#include "draw/png.h"

#include <spng.h>

#include <cstdlib>
#include <memory>
#include <string>

#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"

namespace bodyopt::draw {
namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 30;
// This is the fastest pair of zlib level and PNG filter whose files are no larger than those of stb's encoder.
constexpr int kLevel = 1, kFilter = SPNG_FILTER_CHOICE_SUB;

}  // namespace

std::vector<std::uint8_t> encode_png(const Image& image) {
  const std::uint64_t bytes = std::uint64_t{image.width} * image.height * 4;
  if (bytes == 0 || bytes > kMaxBytes || image.rgba.size() != bytes) {
    throw Error(ErrorKind::usage, "an image of " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                                      " pixels with " + std::to_string(image.rgba.size()) + " bytes is no PNG");
  }
  const auto require = [](int result) {
    if (result != 0) {
      throw Error(ErrorKind::file, std::string("an image could not be encoded as PNG: ") + spng_strerror(result));
    }
  };
  const std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)> encoder(spng_ctx_new(SPNG_CTX_ENCODER), &spng_ctx_free);
  if (!encoder) throw Error(ErrorKind::file, "an image could not be encoded as PNG: out of memory");
  spng_ihdr header{};
  header.width = image.width;
  header.height = image.height;
  header.bit_depth = 8;
  header.color_type = SPNG_COLOR_TYPE_TRUECOLOR_ALPHA;
  require(spng_set_ihdr(encoder.get(), &header));
  require(spng_set_option(encoder.get(), SPNG_ENCODE_TO_BUFFER, 1));
  require(spng_set_option(encoder.get(), SPNG_IMG_COMPRESSION_LEVEL, kLevel));
  require(spng_set_option(encoder.get(), SPNG_FILTER_CHOICE, kFilter));
  require(spng_encode_image(encoder.get(), image.rgba.data(), bytes, SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE));
  std::size_t size = 0;
  int result = 0;
  const std::unique_ptr<void, decltype(&std::free)> png(spng_get_png_buffer(encoder.get(), &size, &result), &std::free);
  require(result);
  const auto* const first = static_cast<const std::uint8_t*>(png.get());
  return {first, first + size};
}

void write_png(const Image& image, const std::filesystem::path& path) {
  const std::vector<std::uint8_t> png = encode_png(image);
  write_file_atomically(path, std::as_bytes(std::span(png)));
}

}  // namespace bodyopt::draw
