#include "cli/report/plots.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "proxy_viewer/render/renderer.h"
#include "runtime/basis/error.h"

namespace bodyopt {
namespace {

constexpr const char* kGrid = "#33373f";
constexpr const char* kText = "#a4a9b3";
constexpr const char* kStrongText = "#e6e8ec";

std::string coordinate(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f", value);
  return text;
}

// Begins an SVG of width x height units that scales with the page.
std::string open_svg(double width, double height, const std::string& description) {
  return "<svg viewBox=\"0 0 " + coordinate(width) + " " + coordinate(height) + "\" role=\"img\" aria-label=\"" +
         escape_html(description) + "\" font-family=\"inherit\" font-size=\"13\">\n";
}

std::string line(double x0, double y0, double x1, double y1, const std::string& colour) {
  return "<line x1=\"" + coordinate(x0) + "\" y1=\"" + coordinate(y0) + "\" x2=\"" + coordinate(x1) + "\" y2=\"" +
         coordinate(y1) + "\" stroke=\"" + escape_html(colour) + "\"/>\n";
}

std::string text_at(double x, double y, const char* anchor, const std::string& colour, const std::string& text,
                    const std::string& attributes = "") {
  return "<text x=\"" + coordinate(x) + "\" y=\"" + coordinate(y) + "\" text-anchor=\"" + anchor + "\" fill=\"" +
         escape_html(colour) + "\"" + attributes + ">" + escape_html(text) + "</text>\n";
}

std::string rectangle(double x, double y, double width, double height, const std::string& colour) {
  return "<rect x=\"" + coordinate(x) + "\" y=\"" + coordinate(y) + "\" width=\"" + coordinate(width) + "\" height=\"" +
         coordinate(height) + "\" rx=\"2\" fill=\"" + escape_html(colour) + "\"/>\n";
}

// The plot's frame in SVG units, and what it shows.
struct Axes {
  static constexpr double kWidth = 960, kHeight = 340, kLeft = 62, kRight = 14, kTop = 34, kBottom = 46;
  double first = 0, last = 1, low = 0.1, high = 1;

  double x(double frame) const {
    return kLeft + (frame - first) / std::max(1.0, last - first) * (kWidth - kLeft - kRight);
  }
  double y(double value) const {
    const double t = std::log(std::clamp(value, low, high) / low) / std::log(high / low);
    return kHeight - kBottom - t * (kHeight - kTop - kBottom);
  }
};

Axes make_axes(const LinePlot& plot) {
  double low = 1e300, high = 0;
  for (const PlotSeries& series : plot.series) {
    if (series.y.size() != plot.x.size()) {
      throw Error(ErrorKind::mismatch, "plot: series '" + series.label + "' has " + std::to_string(series.y.size()) +
                                           " values for " + std::to_string(plot.x.size()) + " frames");
    }
    for (const double value : series.y) {
      if (!std::isfinite(value)) {
        throw Error(ErrorKind::mismatch, "plot: series '" + series.label + "' holds a value that is not finite");
      }
      if (value > 0) low = std::min(low, value), high = std::max(high, value);
    }
  }
  Axes axes;
  if (high > 0) {
    axes.high = round_up(high * 1.05);
    axes.low = std::max(round_up(low) / 2.5, axes.high * 1e-4);
    if (axes.low > low) axes.low = std::max(low * 0.8, axes.high * 1e-4);
  }
  if (!plot.x.empty()) {
    axes.first = plot.x.front();
    axes.last = plot.x.back();
  }
  return axes;
}

std::string value_grid(const Axes& axes) {
  std::string svg;
  for (double decade = std::pow(10.0, std::floor(std::log10(axes.low))); decade <= axes.high; decade *= 10) {
    for (const double step : {1.0, 2.0, 5.0}) {
      const double value = step * decade;
      if (value < axes.low * 0.999 || value > axes.high * 1.001) continue;
      svg += line(Axes::kLeft, axes.y(value), Axes::kWidth - Axes::kRight, axes.y(value), kGrid);
      svg += text_at(Axes::kLeft - 8, axes.y(value) + 4, "end", kText, number_text(value));
    }
  }
  return svg;
}

std::string frame_ticks(const Axes& axes) {
  std::string svg;
  const double step = std::max(1.0, round_up((axes.last - axes.first) / 10));
  const double bottom = Axes::kHeight - Axes::kBottom;
  for (double frame = std::ceil(axes.first / step) * step; frame <= axes.last; frame += step) {
    svg += line(axes.x(frame), bottom, axes.x(frame), bottom + 5, kText);
    svg += text_at(axes.x(frame), bottom + 19, "middle", kText, number_text(frame, 9));
  }
  return svg;
}

std::string curve(const Axes& axes, const std::vector<int>& frames, const PlotSeries& series) {
  const auto gap = [&](std::size_t i) { return static_cast<double>(frames[i]) - frames[i - 1]; };
  double usual = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < frames.size(); ++i) usual = std::min(usual, gap(i));
  std::string path;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const bool continues = i > 0 && gap(i) <= usual;
    path += (continues ? "L" : "M") + coordinate(axes.x(frames[i])) + " " + coordinate(axes.y(series.y[i]));
  }
  return "<path d=\"" + path + "\" fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\" stroke=\"" +
         escape_html(series.colour) + "\" stroke-width=\"" + (series.emphasised ? "2.8" : "1.6") + "\"/>\n";
}

std::string legend(const LinePlot& plot) {
  std::string svg;
  double x = Axes::kLeft;
  for (const PlotSeries& series : plot.series) {
    svg += rectangle(x, 10, 18, 4, series.colour) + text_at(x + 24, 16, "start", kStrongText, series.label);
    x += 52 + 7.5 * static_cast<double>(series.label.size());
  }
  return svg;
}

std::string css_colour(const std::array<float, 3>& linear) {
  int srgb[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const double c = static_cast<double>(linear[i]);
    srgb[i] = static_cast<int>(std::lround(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055)));
  }
  char text[8];
  std::snprintf(text, sizeof(text), "#%02x%02x%02x", srgb[0] & 255, srgb[1] & 255, srgb[2] & 255);
  return text;
}

}  // namespace

std::string line_plot(const LinePlot& plot) {
  const Axes axes = make_axes(plot);
  const double middle = (Axes::kTop + Axes::kHeight - Axes::kBottom) / 2;
  std::string svg = open_svg(Axes::kWidth, Axes::kHeight, plot.y_label + " over " + plot.x_label);
  svg += value_grid(axes) + frame_ticks(axes) + legend(plot);
  svg += text_at((Axes::kLeft + Axes::kWidth) / 2, Axes::kHeight - 6, "middle", kText, plot.x_label);
  svg += text_at(14, middle, "middle", kText, plot.y_label, " transform=\"rotate(-90 14 " + coordinate(middle) + ")\"");
  for (const PlotSeries& series : plot.series) svg += curve(axes, plot.x, series);
  return svg + "</svg>\n";
}

std::string bar_chart(std::span<const Bar> bars) {
  constexpr double kWidth = 960, kRow = 34, kLabel = 190, kValue = 110;
  double longest = 0;
  for (const Bar& bar : bars) longest = std::max(longest, bar.value);
  std::string svg = open_svg(kWidth, kRow * static_cast<double>(bars.size()) + 4, "bars");
  double y = 2;
  for (const Bar& bar : bars) {
    const double length = longest > 0 ? std::max(2.0, bar.value / longest * (kWidth - kLabel - kValue)) : 2;
    svg += text_at(kLabel - 12, y + 21, "end", kStrongText, bar.label);
    svg += rectangle(kLabel, y + 5, length, kRow - 10, bar.colour);
    svg += text_at(kLabel + length + 10, y + 21, "start", kStrongText, bar.text);
    y += kRow;
  }
  return svg + "</svg>\n";
}

std::string colour_bar(double scale_mm) {
  constexpr double kWidth = 360, kHeight = 40, kMargin = 24, kBar = 14;
  constexpr int kSteps = 64, kTicks = 4;
  std::string svg = open_svg(kWidth, kHeight, "colours from 0 to " + number_text(scale_mm) + " mm");
  const double step = (kWidth - 2 * kMargin) / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const float t = (static_cast<float>(i) + 0.5f) / kSteps;
    svg += "<rect x=\"" + coordinate(kMargin + i * step) + "\" y=\"2\" width=\"" + coordinate(step + 0.6) +
           "\" height=\"" + coordinate(kBar) + "\" shape-rendering=\"crispEdges\" fill=\"" +
           css_colour(heat_colour(t)) + "\"/>\n";
  }
  for (int i = 0; i <= kTicks; ++i) {
    const double x = kMargin + i * (kWidth - 2 * kMargin) / kTicks;
    const std::string value = number_text(scale_mm * i / kTicks);
    svg += line(x, kBar + 2, x, kBar + 7, kText);
    svg += text_at(x, kHeight - 6, "middle", kText, i == kTicks ? value + " mm" : value);
  }
  return svg + "</svg>\n";
}

double round_up(double value) {
  if (!(value > 0) || !std::isfinite(value)) return 1;
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (value <= step * decade * (1 + 1e-12)) return step * decade;
  }
  return 10 * decade;
}

std::string number_text(double value, int digits) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.*g", digits, value);
  const double shown = std::strtod(text, nullptr);
  if (std::abs(shown) >= 1000 && std::abs(shown) < 1e15) std::snprintf(text, sizeof(text), "%.0f", shown);
  return text;
}

std::string escape_html(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

}  // namespace bodyopt
