#include "draw/image_decode.h"

#include <spng.h>
#include <stb/stb_image.h>
#include <webp/decode.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>

#include "runtime/core/error.h"

namespace bodyopt::draw {
namespace {

using Bytes = std::span<const unsigned char>;

[[noreturn]] void refuse_image(const std::string& why) { throw Error(ErrorKind::file, why); }

// An image of any size may be of one colour, and so take few bytes. Beyond 4096 x 4096 pixels it must have one for each
// 4096 of them, which such images nearly have: otherwise a few bytes that are damaged would take much memory.
Image sized(std::uint32_t width, std::uint32_t height, std::size_t bytes) {
  constexpr std::size_t kOfFewBytes = 4096 * 4096, kPixelsOfByte = 4096;
  if (width == 0 || height == 0 || width > kMostImagePixels || height > kMostImagePixels) {
    refuse_image("has " + std::to_string(width) + " x " + std::to_string(height) + " pixels, expected 1 to " +
                 std::to_string(kMostImagePixels) + " a side");
  }
  const std::size_t pixels = std::size_t{width} * height;
  if (pixels > std::max(kOfFewBytes, kPixelsOfByte * bytes)) {
    refuse_image("claims " + std::to_string(width) + " x " + std::to_string(height) + " pixels in " +
                 std::to_string(bytes) + " bytes: damaged?");
  }
  return {width, height, std::vector<std::uint8_t>(4 * pixels)};
}

Image decode_png(Bytes bytes) {
  const auto require = [](int result) {
    if (result != 0) refuse_image(std::string("is a damaged PNG, or cut off: ") + spng_strerror(result));
  };
  const std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)> decoder(spng_ctx_new(0), &spng_ctx_free);
  if (!decoder) refuse_image("cannot be decoded: out of memory");
  spng_ihdr header{};
  require(spng_set_png_buffer(decoder.get(), bytes.data(), bytes.size()));
  require(spng_set_chunk_limits(decoder.get(), bytes.size(), bytes.size()));
  require(spng_get_ihdr(decoder.get(), &header));
  Image image = sized(header.width, header.height, bytes.size());
  require(spng_decode_image(decoder.get(), image.rgba.data(), image.rgba.size(), SPNG_FMT_RGBA8, SPNG_DECODE_TRNS));
  return image;
}

// stb fills what is missing with grey, and reports no error.
bool is_cut_off(Bytes jpeg) {
  constexpr std::array<unsigned char, 2> kEnd{0xff, 0xd9};
  const Bytes tail = jpeg.last(std::min<std::size_t>(jpeg.size(), 4096));
  return std::search(tail.begin(), tail.end(), kEnd.begin(), kEnd.end()) == tail.end();
}

Image decode_jpeg(Bytes bytes) {
  int width = 0, height = 0, channels = 0;
  const int size = static_cast<int>(bytes.size());
  if (bytes.size() > std::size_t{1} << 30 || is_cut_off(bytes) ||
      stbi_info_from_memory(bytes.data(), size, &width, &height, &channels) == 0) {
    refuse_image("is a damaged JPEG, or cut off");
  }
  Image image = sized(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), bytes.size());
  const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> pixels(
      stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, 4), &stbi_image_free);
  if (!pixels) refuse_image(std::string("is a damaged JPEG: ") + stbi_failure_reason());
  std::copy_n(pixels.get(), image.rgba.size(), image.rgba.begin());
  return image;
}

Image decode_webp(Bytes bytes) {
  int width = 0, height = 0;
  if (WebPGetInfo(bytes.data(), bytes.size(), &width, &height) == 0) refuse_image("is a damaged WebP, or cut off");
  Image image = sized(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), bytes.size());
  if (WebPDecodeRGBAInto(bytes.data(), bytes.size(), image.rgba.data(), image.rgba.size(), 4 * width) == nullptr) {
    refuse_image("is a damaged WebP, or cut off");
  }
  return image;
}

}  // namespace

Image decode_image(std::span<const std::byte> given) {
  const Bytes bytes(reinterpret_cast<const unsigned char*>(given.data()), given.size());
  const std::string_view text(reinterpret_cast<const char*>(given.data()), given.size());
  if (text.starts_with("\x89PNG")) return decode_png(bytes);
  if (text.starts_with("\xff\xd8\xff")) return decode_jpeg(bytes);
  if (text.starts_with("RIFF")) return decode_webp(bytes);
  refuse_image("is neither PNG, JPEG nor WebP");
}

}  // namespace bodyopt::draw
