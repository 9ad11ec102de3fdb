#include "draw/animation.h"

#include <webp/encode.h>
#include <webp/mux.h>

#include <cmath>
#include <memory>
#include <string>

#include "runtime/core/error.h"

namespace bodyopt::draw {
namespace {

constexpr float kQuality = 90;  // of 100: a level or two of 255 on a shaded skin, at a fraction of the lossless size

[[noreturn]] void fail(const std::string& why) {
  throw Error(ErrorKind::file, "frames could not be encoded as WebP: " + why);
}

using Encoder = std::unique_ptr<WebPAnimEncoder, decltype(&WebPAnimEncoderDelete)>;

[[noreturn]] void refuse_length(double milliseconds) {
  throw Error(ErrorKind::usage, "frames of " + std::to_string(milliseconds) + " milliseconds make no animation");
}

void check(const Image& frame, std::uint32_t width, std::uint32_t height) {
  const std::uint64_t bytes = std::uint64_t{frame.width} * frame.height * 4;
  const bool fits = bytes > 0 && frame.rgba.size() == bytes && frame.width <= WEBP_MAX_DIMENSION &&
                    frame.height <= WEBP_MAX_DIMENSION;
  if (fits && frame.width == width && frame.height == height) return;
  throw Error(ErrorKind::usage, "a frame of ", frame.width, " x ", frame.height, " pixels with ", frame.rgba.size(),
              " bytes does not fit an animation of ", width, " x ", height);
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

struct AnimationEncoder::Impl {
  explicit Impl(double each) : milliseconds(each), encoder(nullptr, WebPAnimEncoderDelete) {
    if (!(milliseconds >= 1)) refuse_length(milliseconds);
    if (WebPConfigPreset(&config, WEBP_PRESET_DRAWING, kQuality) == 0) {
      fail("the library is of another version than its header");
    }
  }

  int now() const {  // where the next frame begins
    const double at = static_cast<double>(count) * milliseconds;
    if (!(at < 1e9)) refuse_length(milliseconds);
    return static_cast<int>(std::lround(at));
  }

  double milliseconds;
  WebPConfig config;
  Encoder encoder;  // from the first frame on
  std::uint32_t width = 0, height = 0;
  std::size_t count = 0;
};

AnimationEncoder::AnimationEncoder(double milliseconds) : impl_(std::make_unique<Impl>(milliseconds)) {}

AnimationEncoder::~AnimationEncoder() = default;

void AnimationEncoder::add(const Image& frame) {
  Impl& a = *impl_;
  const bool first = a.count == 0;
  check(frame, first ? frame.width : a.width, first ? frame.height : a.height);
  if (first) {
    a.encoder = make_encoder(frame);
    a.width = frame.width;
    a.height = frame.height;
  }
  Picture picture(frame);
  if (WebPAnimEncoderAdd(a.encoder.get(), picture.get(), a.now(), &a.config) == 0) {
    fail(WebPAnimEncoderGetError(a.encoder.get()));
  }
  ++a.count;
}

std::vector<std::uint8_t> AnimationEncoder::finish() {
  Impl& a = *impl_;
  if (a.count == 0) throw Error(ErrorKind::usage, "an animation needs one frame or more");
  // No frame: the end of the last one.
  if (WebPAnimEncoderAdd(a.encoder.get(), nullptr, a.now(), nullptr) == 0) {
    fail(WebPAnimEncoderGetError(a.encoder.get()));
  }
  return assemble(a.encoder.get());
}

std::vector<std::uint8_t> encode_animation(std::span<const Image> frames, double milliseconds) {
  AnimationEncoder encoder(milliseconds);
  for (const Image& frame : frames) encoder.add(frame);
  return encoder.finish();
}

}  // namespace bodyopt::draw
