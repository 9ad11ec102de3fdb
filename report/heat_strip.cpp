#include "report/heat_strip.h"

#include <algorithm>

#include "draw/heat_colour.h"
#include "draw/srgb.h"
#include "report/html.h"
#include "report/plots.h"
#include "report/svg.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr double kRight = 936, kTop = 24, kBelow = 100;
constexpr std::size_t kMostColumns = 700;  // about a pixel each
constexpr std::size_t kWholeRows = 2;      // the whole skin's row is twice as high as a region's

void check(const HeatStrip& strip) {
  const std::size_t frames = strip.frames.frames.size();
  const bool fits = frames > 0 && strip.whole_mm.size() == frames && strip.regions_mm.size() == frames &&
                    std::all_of(strip.regions_mm.begin(), strip.regions_mm.end(),
                                [&](const std::vector<double>& frame) { return frame.size() == strip.regions.size(); });
  if (!fits) {
    throw Error(ErrorKind::mismatch, "heat strip: expected errors of " + std::to_string(frames) + " frames and " +
                                         std::to_string(strip.regions.size()) + " regions");
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
Image paint(const Cells& cells, double scale_mm) {
  constexpr std::size_t kRowPixels = 8;
  const std::size_t column_pixels = 1 + 2 * kMostColumns / cells.columns;
  Image image;
  image.width = static_cast<std::uint32_t>(column_pixels * cells.columns);
  image.height = static_cast<std::uint32_t>(kRowPixels * (cells.rows + kWholeRows - 1));
  for (std::size_t y = 0; y < image.height; ++y) {
    const std::size_t line_of = y / kRowPixels, row = line_of < kWholeRows ? 0 : line_of - kWholeRows + 1;
    for (std::size_t x = 0; x < image.width; ++x) {
      const double mm = cells.mm[row * cells.columns + x / column_pixels];
      const std::array<std::uint8_t, 3> colour = srgb(heat_colour(static_cast<float>(mm / scale_mm)));
      image.rgba.insert(image.rgba.end(), colour.begin(), colour.end());
      image.rgba.push_back(255);
    }
  }
  return image;
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
  const double pixels = static_cast<double>(cells.rows + kWholeRows - 1);
  const FrameArea area{24 + kCharacterWidth * static_cast<double>(longest), kRight, kTop, kTop + row * pixels};

  std::string svg = open_svg(kPlotWidth, area.bottom + kBelow, "expected error of every frame and region");
  svg += "<image x=\"" + coordinate(area.left) + "\" y=\"" + coordinate(area.top) + "\" width=\"" +
         coordinate(area.right - area.left) + "\" height=\"" + coordinate(area.bottom - area.top) +
         "\" preserveAspectRatio=\"none\" xlink:href=\"data:image/png;base64," +
         encode_base64(encode_png(paint(cells, scale_mm))) + "\"/>\n";
  svg += text_at(area.left - 10, area.top + row + 5, "end", kStrongTextColour, "whole skin", " font-weight=\"600\"");
  for (std::size_t r = 0; r < strip.regions.size(); ++r) {
    const double top = area.top + row * static_cast<double>(kWholeRows + r);
    svg += line(area.left, top, area.right, top, "#1c1f25");
    svg += text_at(area.left - 10, top + row / 2 + 4.5, "end", kTextColour, shortened(strip.regions[r]));
  }
  svg += draw_frame_axis(strip.frames, area);
  svg += text_at((area.left + area.right) / 2, area.bottom + 38, "middle", kTextColour, "frame");
  svg += text_at(area.left - 10, area.bottom + 67, "end", kTextColour, "expected RMS");
  svg += colour_ramp(area.left + 6, area.bottom + 56, 320, scale_mm);
  return svg + "</svg>\n";
}

}  // namespace bodyopt
