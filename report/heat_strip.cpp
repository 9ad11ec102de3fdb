#include "report/heat_strip.h"

#include <algorithm>
#include <cmath>

#include "draw/colours.h"
#include "report/page.h"
#include "report/pictures.h"
#include "runtime/core/error.h"
#include "runtime/core/text.h"

namespace bodyopt::report {
namespace {

constexpr const char* kQuiet = "#a4a9b3";
constexpr double kWidth = 960, kRight = 936, kTop = 24, kBelow = 100, kCharacterWidth = 7.2;
constexpr std::size_t kMostColumns = 700;  // about a pixel each
constexpr std::size_t kWholeRows = 2;      // the whole skin's row is twice as high as a region's

void check(const HeatStrip& strip) {
  const std::size_t frames = strip.frames.size();
  const bool fits = frames > 0 && strip.whole_mm.size() == frames && strip.regions_mm.size() == frames &&
                    std::ranges::all_of(strip.regions_mm, [&](const std::vector<double>& frame) {
                      return frame.size() == strip.regions.size();
                    });
  if (!fits) {
    throw Error(ErrorKind::mismatch, "heat strip: expected errors of ", frames, " frames and ", strip.regions.size(),
                " regions");
  }
}

// Errors by row and column, the whole skin first.
struct Cells {
  std::size_t rows, columns;
  std::vector<double> mm;
  double largest = 0;

  explicit Cells(const HeatStrip& strip)
      : rows(1 + strip.regions.size()), columns(std::min(strip.whole_mm.size(), kMostColumns)), mm(rows * columns) {
    const std::size_t frames = strip.whole_mm.size();
    for (std::size_t k = 0; k < frames; ++k) {
      for (std::size_t row = 0; row < rows; ++row) {
        double& cell = mm[row * columns + k * columns / frames];
        cell = std::max(cell, row == 0 ? strip.whole_mm[k] : strip.regions_mm[k][row - 1]);
        largest = std::max(largest, cell);
      }
    }
  }
};

// Several pixels per cell, so that programs which smooth a picture as they enlarge it leave the cells sharp.
draw::Image paint(const Cells& cells, double scale_mm) {
  constexpr std::size_t kRowPixels = 8;
  const std::size_t column_pixels = 1 + 2 * kMostColumns / cells.columns;
  draw::Image image;
  image.width = static_cast<std::uint32_t>(column_pixels * cells.columns);
  image.height = static_cast<std::uint32_t>(kRowPixels * (cells.rows + kWholeRows - 1));
  for (std::size_t y = 0; y < image.height; ++y) {
    const std::size_t line_of = y / kRowPixels, row = line_of < kWholeRows ? 0 : line_of - kWholeRows + 1;
    for (std::size_t x = 0; x < image.width; ++x) {
      const double mm = cells.mm[row * cells.columns + x / column_pixels];
      const std::array<std::uint8_t, 3> colour = draw::srgb(draw::heat_colour(static_cast<float>(mm / scale_mm)));
      image.rgba.insert(image.rgba.end(), colour.begin(), colour.end());
      image.rgba.push_back(255);
    }
  }
  return image;
}

std::string number(double value) { return formatted("%.6g", value); }

// An element from its name and its attributes, names and values in turn.
std::string tag(const std::string& name, const std::vector<std::pair<const char*, std::string>>& attributes,
                const std::string& content = "") {
  std::string text = "<" + name;
  for (const auto& [key, value] : attributes) text += std::string(" ") + key + "=\"" + value + "\"";
  return text + ">" + content + "</" + name + ">\n";
}

std::string text_at(double x, double y, const char* anchor, const std::string& text, const char* colour = kQuiet) {
  std::string escaped;
  for (const char c : text) escaped += c == '&' ? "&amp;" : c == '<' ? "&lt;" : std::string(1, c);
  return tag("text", {{"x", number(x)}, {"y", number(y)}, {"text-anchor", anchor}, {"fill", colour}}, escaped);
}

std::string line(double x1, double y1, double x2, double y2, const char* colour = kQuiet) {
  return tag("line",
             {{"x1", number(x1)}, {"y1", number(y1)}, {"x2", number(x2)}, {"y2", number(y2)}, {"stroke", colour}});
}

// The colours from 0 to the scale, with ticks.
std::string colour_ramp(double x, double y, double scale_mm) {
  constexpr double kRamp = 320, kBar = 14;
  constexpr int kSteps = 64, kTicks = 4;
  std::string svg;
  for (int i = 0; i < kSteps; ++i) {
    svg += tag("rect", {{"x", number(x + i * kRamp / kSteps)},
                        {"y", number(y)},
                        {"width", number(kRamp / kSteps + 0.6)},
                        {"height", number(kBar)},
                        {"fill", css_colour(draw::heat_colour((static_cast<float>(i) + 0.5f) / kSteps))}});
  }
  for (int i = 0; i <= kTicks; ++i) {
    const double at = x + i * kRamp / kTicks;
    svg += line(at, y + kBar, at, y + kBar + 5);
    svg += text_at(at, y + kBar + 18, "middle", number(scale_mm * i / kTicks) + (i == kTicks ? " mm" : ""));
  }
  return svg;
}

// Below the columns: the first frame, and those at or past multiples of a round number, where there is room.
std::string frame_numbers(const std::vector<int>& frames, double left, double bottom) {
  constexpr double kRoom = 46;
  const double width = (kRight - left) / static_cast<double>(frames.size());
  const double least = kRoom / width * (frames.back() - frames.front() + 1) / static_cast<double>(frames.size());
  double step = 1;
  for (int k = 0; step < least; ++k) step *= k % 3 == 1 ? 2.5 : 2;  // 1, 2, 5, 10
  std::string svg;
  double free_from = 0;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const double x = left + (static_cast<double>(k) + 0.5) * width;
    const bool is_past = k == 0 || std::floor(frames[k] / step) > std::floor(frames[k - 1] / step);
    if (!is_past || x < free_from) continue;
    svg += line(x, bottom, x, bottom + 5) + text_at(x, bottom + 19, "middle", std::to_string(frames[k]));
    free_from = x + kRoom;
  }
  return svg + text_at((left + kRight) / 2, bottom + 38, "middle", "frame");
}

std::string shortened(const std::string& name) {
  constexpr std::size_t kMost = 30;
  return name.size() <= kMost ? name : name.substr(0, kMost - 3) + "...";
}

}  // namespace

std::string heat_strip(const HeatStrip& strip) {
  check(strip);
  const Cells cells(strip);
  const double scale_mm = heat_scale(cells.largest), row = strip.regions.size() > 30 ? 15 : 20;
  std::size_t longest = std::string("whole skin").size();
  for (const std::string& name : strip.regions) longest = std::max(longest, shortened(name).size());
  const double left = 24 + kCharacterWidth * static_cast<double>(longest),
               bottom = kTop + row * static_cast<double>(cells.rows + kWholeRows - 1);
  std::string svg = tag("rect", {{"width", "100%"}, {"height", "100%"}, {"fill", "#1c1f25"}});
  svg += tag("image", {{"x", number(left)},
                       {"y", number(kTop)},
                       {"width", number(kRight - left)},
                       {"height", number(bottom - kTop)},
                       {"preserveAspectRatio", "none"},
                       {"xlink:href", data_url("image/png", draw::encode_png(paint(cells, scale_mm)))}});
  svg += text_at(left - 10, kTop + row + 5, "end", "whole skin", "#e6e8ec");
  for (std::size_t r = 0; r < strip.regions.size(); ++r) {
    const double top = kTop + row * static_cast<double>(kWholeRows + r);
    svg += line(left, top, kRight, top, "#1c1f25");
    svg += text_at(left - 10, top + row / 2 + 4.5, "end", shortened(strip.regions[r]));
  }
  svg += frame_numbers(strip.frames, left, bottom) + text_at(left - 10, bottom + 67, "end", "expected RMS");
  svg += colour_ramp(left + 6, bottom + 56, scale_mm);
  return tag("svg",
             {{"xmlns", "http://www.w3.org/2000/svg"},
              {"xmlns:xlink", "http://www.w3.org/1999/xlink"},
              {"viewBox", "0 0 " + number(kWidth) + " " + number(bottom + kBelow)},
              {"font-family", "sans-serif"},
              {"font-size", "13"}},
             svg);
}

}  // namespace bodyopt::report
