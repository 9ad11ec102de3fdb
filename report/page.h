// A page for people: one HTML file that holds its figures as JSON and shows them by the scripts of report/page. It
// needs nothing from elsewhere.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "dataset/compare.h"
#include "draw/png.h"

namespace bodyopt::report {

// Encodes a picture, or a WebP of width x height pixels, for a page: {"src": data URL, "width", "height"}.
Json page_picture(const draw::Image& image);
Json page_animation(std::span<const std::uint8_t> webp, std::uint32_t width, std::uint32_t height);

// `kind`: "report", "show" or "transfer", which says what figures and pictures are expected. `figures`: as programs
// read them. Bytes that are no UTF-8 are replaced.
std::string page_text(const std::string& kind, const Json& figures, const Json& pictures);

std::string data_url(const std::string& type, std::span<const std::uint8_t> bytes);

// A colour of the renderer (linear RGB), for CSS.
std::string css_colour(const std::array<float, 3>& linear);

}  // namespace bodyopt::report
