// An animated WebP, decoded.
#pragma once

#include <webp/demux.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace bodyopt {

struct DecodedAnimation {
  std::uint32_t width = 0, height = 0, loops = 1;
  std::vector<std::vector<std::uint8_t>> frames;  // height x width x 4 each
  std::vector<int> ends;                          // when each goes, milliseconds; none where it cannot be decoded
};

inline DecodedAnimation decode_animation(const std::vector<std::uint8_t>& bytes) {
  DecodedAnimation result;
  WebPAnimDecoderOptions options;
  WebPAnimDecoderOptionsInit(&options);
  options.color_mode = MODE_RGBA;
  const WebPData data{bytes.data(), bytes.size()};
  const std::unique_ptr<WebPAnimDecoder, decltype(&WebPAnimDecoderDelete)> decoder(WebPAnimDecoderNew(&data, &options),
                                                                                   WebPAnimDecoderDelete);
  WebPAnimInfo info;
  if (!decoder || WebPAnimDecoderGetInfo(decoder.get(), &info) == 0) return result;
  result.width = info.canvas_width;
  result.height = info.canvas_height;
  result.loops = info.loop_count;
  while (WebPAnimDecoderHasMoreFrames(decoder.get()) != 0) {
    std::uint8_t* pixels = nullptr;
    int end = 0;
    if (WebPAnimDecoderGetNext(decoder.get(), &pixels, &end) == 0) return {};
    result.frames.emplace_back(pixels, pixels + std::size_t{4} * info.canvas_width * info.canvas_height);
    result.ends.push_back(end);
  }
  return result;
}

}  // namespace bodyopt
