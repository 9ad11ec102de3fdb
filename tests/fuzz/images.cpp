// Images of materials, as pixels.
#include <stb/stb_image_write.h>
#include <webp/encode.h>

#include "draw/image_decode.h"
#include "tests/fuzz/fuzz_target.h"

namespace bodyopt::fuzz {
namespace {

using namespace draw;

void append_bytes(void* to, void* bytes, int count) {
  static_cast<std::string*>(to)->append(static_cast<const char*>(bytes), static_cast<std::size_t>(count));
}

std::vector<std::string> image_seeds() {
  constexpr int kSide = 9;
  std::vector<std::uint8_t> pixels;
  for (int k = 0; k < 4 * kSide * kSide; ++k) pixels.push_back(static_cast<std::uint8_t>(37 * k));
  const std::vector<std::uint8_t> png = encode_png({kSide, kSide, pixels});
  std::string jpeg;
  stbi_write_jpg_to_func(append_bytes, &jpeg, kSide, kSide, 4, pixels.data(), 80);
  std::uint8_t* webp = nullptr;
  const std::size_t size = WebPEncodeLosslessRGBA(pixels.data(), kSide, kSide, 4 * kSide, &webp);
  const std::string encoded(reinterpret_cast<const char*>(webp), size);
  WebPFree(webp);
  return {std::string(png.begin(), png.end()), jpeg, encoded};
}

void read_image(const std::string& bytes) { decode_image(std::as_bytes(std::span(bytes))); }

// 4096 x 4096 pixels may take few bytes, and decoders hold them more than once.
const bool added = add_target({"images", image_seeds, read_image, 256});

}  // namespace
}  // namespace bodyopt::fuzz
