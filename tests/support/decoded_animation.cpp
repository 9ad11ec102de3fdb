#include "tests/support/decoded_animation.h"

#include <webp/demux.h>

#include <memory>

namespace bodyopt {

DecodedAnimation decode_animation(const std::vector<std::uint8_t>& bytes) {
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
