#include "report/page.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "draw/colours.h"
#include "report/page_html.h"
#include "runtime/core/text.h"

namespace bodyopt::report {
namespace {

// The colour scale of heat maps, from 0 to its end.
Json heat_colours() {
  constexpr int kColours = 64;
  Json colours = Json::array();
  for (int i = 0; i < kColours; ++i) {
    colours.push_back(css_colour(draw::heat_colour((static_cast<float>(i) + 0.5f) / kColours)));
  }
  return colours;
}

// JSON between tags: without '<', none of its texts ends or begins one.
std::string without_tags(const std::string& json) {
  std::string text;
  for (const char c : json) text += c == '<' ? "\\u003c" : std::string(1, c);
  return text;
}

std::string encode_base64(std::span<const std::uint8_t> bytes) {
  constexpr const char* kBase64 = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < count ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kBase64[word >> (18 - 6 * k) & 63u] : '=';
  }
  return text;
}

}  // namespace

Json page_picture(const draw::Image& image) {
  return {{"src", data_url("image/png", draw::encode_png(image))}, {"width", image.width}, {"height", image.height}};
}

Json page_animation(std::span<const std::uint8_t> webp, std::uint32_t width, std::uint32_t height) {
  return {{"src", data_url("image/webp", webp)}, {"width", width}, {"height", height}};
}

std::string page_text(const std::string& kind, const Json& figures, const Json& pictures) {
  const Json contents = {
      {"kind", kind}, {"figures", figures}, {"pictures", pictures}, {"heat_colours", heat_colours()}};
  const std::string json = contents.dump(-1, ' ', false, Json::error_handler_t::replace);
  return kPageHtml[0] + without_tags(json) + kPageHtml[1];
}

std::string data_url(const std::string& type, std::span<const std::uint8_t> bytes) {
  return "data:" + type + ";base64," + encode_base64(bytes);
}

std::string css_colour(const std::array<float, 3>& linear) {
  const std::array<std::uint8_t, 3> colour = draw::srgb(linear);
  return formatted("#%02x%02x%02x", colour[0], colour[1], colour[2]);
}

}  // namespace bodyopt::report
