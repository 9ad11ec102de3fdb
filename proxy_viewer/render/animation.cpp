#include "proxy_viewer/render/animation.h"

#include <webp/encode.h>
#include <webp/mux.h>

#include <cmath>
#include <memory>
#include <string>

#include "runtime/basis/error.h"

namespace bodyopt {
namespace {

constexpr float kQuality = 90;  // of 100: a level or two of 255 on a shaded skin, at a fraction of the lossless size

[[noreturn]] void fail(const std::string& why) {
  throw Error(ErrorKind::file, "frames could not be encoded as WebP: " + why);
}

using Encoder = std::unique_ptr<WebPAnimEncoder, decltype(&WebPAnimEncoderDelete)>;

void check(std::span<const Image> frames, double milliseconds) {
  if (frames.empty()) throw Error(ErrorKind::usage, "an animation needs one frame or more");
  if (!(milliseconds >= 1) || !(milliseconds * static_cast<double>(frames.size()) < 1e9)) {
    throw Error(ErrorKind::usage, "frames of " + std::to_string(milliseconds) + " milliseconds make no animation");
  }
  const Image& first = frames.front();
  for (const Image& frame : frames) {
    const std::uint64_t bytes = std::uint64_t{frame.width} * frame.height * 4;
    const bool fits = bytes > 0 && frame.rgba.size() == bytes && frame.width <= WEBP_MAX_DIMENSION &&
                      frame.height <= WEBP_MAX_DIMENSION;
    if (fits && frame.width == first.width && frame.height == first.height) continue;
    throw Error(ErrorKind::usage, "a frame of " + std::to_string(frame.width) + " x " + std::to_string(frame.height) +
                                      " pixels with " + std::to_string(frame.rgba.size()) +
                                      " bytes does not fit an animation of " + std::to_string(first.width) + " x " +
                                      std::to_string(first.height));
  }
}

class Picture {
 public:
  explicit Picture(const Image& image) {
    if (WebPPictureInit(&picture_) == 0) fail("the library is of another version than its header");
    picture_.width = static_cast<int>(image.width);
    picture_.height = static_cast<int>(image.height);
    picture_.use_argb = 1;
    if (WebPPictureImportRGBX(&picture_, image.rgba.data(), 4 * picture_.width) == 0) fail("out of memory");
  }
  ~Picture() { WebPPictureFree(&picture_); }
  Picture(const Picture&) = delete;
  Picture& operator=(const Picture&) = delete;
  WebPPicture* get() { return &picture_; }

 private:
  WebPPicture picture_;
};

Encoder make_encoder(const Image& frame) {
  WebPAnimEncoderOptions options;
  if (WebPAnimEncoderOptionsInit(&options) == 0) fail("the library is of another version than its header");
  options.anim_params.loop_count = 0;  // for ever
  options.kmax = 1;                    // every frame whole: what changes slowly would be left standing in blocks
  Encoder encoder(WebPAnimEncoderNew(static_cast<int>(frame.width), static_cast<int>(frame.height), &options),
                  WebPAnimEncoderDelete);
  if (!encoder) fail("out of memory");
  return encoder;
}

std::vector<std::uint8_t> assemble(WebPAnimEncoder* encoder) {
  WebPData data;
  WebPDataInit(&data);
  if (WebPAnimEncoderAssemble(encoder, &data) == 0) fail(WebPAnimEncoderGetError(encoder));
  const std::vector<std::uint8_t> bytes(data.bytes, data.bytes + data.size);
  WebPDataClear(&data);
  return bytes;
}

}  // namespace

std::vector<std::uint8_t> encode_animation(std::span<const Image> frames, double milliseconds) {
  check(frames, milliseconds);
  WebPConfig config;
  if (WebPConfigPreset(&config, WEBP_PRESET_DRAWING, kQuality) == 0) {
    fail("the library is of another version than its header");
  }
  const Encoder encoder = make_encoder(frames.front());
  const auto begin_of = [&](std::size_t frame) {
    return static_cast<int>(std::lround(static_cast<double>(frame) * milliseconds));
  };
  for (std::size_t k = 0; k < frames.size(); ++k) {
    Picture picture(frames[k]);
    if (WebPAnimEncoderAdd(encoder.get(), picture.get(), begin_of(k), &config) == 0) {
      fail(WebPAnimEncoderGetError(encoder.get()));
    }
  }
  // No frame: the end of the last one.
  if (WebPAnimEncoderAdd(encoder.get(), nullptr, begin_of(frames.size()), nullptr) == 0) {
    fail(WebPAnimEncoderGetError(encoder.get()));
  }
  return assemble(encoder.get());
}

}  // namespace bodyopt
