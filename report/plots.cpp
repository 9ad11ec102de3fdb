#include "report/plots.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "draw/heat_colour.h"
#include "draw/renderer.h"
#include "report/svg.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr double kHeight = 340;
constexpr FrameArea kArea{.left = 62, .right = 946, .top = 46, .bottom = 294};

struct Scale {
  double low = 0.1, high = 1;
};

Scale make_scale(const LinePlot& plot) {
  double low = 1e300, high = 0;
  for (const PlotSeries& series : plot.series) {
    if (series.y.size() != plot.x.frames.size()) {
      throw Error(ErrorKind::mismatch, "plot: series '" + series.label + "' has " + std::to_string(series.y.size()) +
                                           " values for " + std::to_string(plot.x.frames.size()) + " frames");
    }
    for (const double value : series.y) {
      if (!std::isfinite(value)) {
        throw Error(ErrorKind::mismatch, "plot: series '" + series.label + "' holds a value that is not finite");
      }
      if (value > 0) low = std::min(low, value), high = std::max(high, value);
    }
  }
  Scale scale;
  if (!(high > 0)) return scale;
  scale.high = round_up(high * 1.05);
  scale.low = std::max(round_up(low) / 2.5, scale.high * 1e-3);
  if (scale.low > low) scale.low = std::max(low * 0.8, scale.high * 1e-3);
  return scale;
}

std::string curve(const FrameAxis& axis, const Scale& scale, const PlotSeries& series) {
  const std::vector<bool> broken = gaps(axis);
  std::string path;
  for (std::size_t k = 0; k < axis.frames.size(); ++k) {
    const double y = kArea.bottom - log_position(series.y[k], scale.low, scale.high) * (kArea.bottom - kArea.top);
    path += (broken[k] ? "M" : "L") + coordinate(column_x(axis, kArea, k)) + " " + coordinate(y);
    const bool alone = broken[k] && (k + 1 == axis.frames.size() || broken[k + 1]);
    if (alone) path += "h0";  // a dot
  }
  return "<path d=\"" + path + "\" fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\" stroke=\"" +
         escape_html(series.colour) + "\" stroke-width=\"" + (series.emphasised ? "2.8" : "1.6") + "\"/>\n";
}

std::string legend(const LinePlot& plot) {
  std::string svg;
  double x = kArea.left;
  for (const PlotSeries& series : plot.series) {
    svg += rectangle(x, 10, 18, 4, series.colour) + text_at(x + 24, 16, "start", kStrongTextColour, series.label);
    x += 52 + kCharacterWidth * static_cast<double>(series.label.size());
  }
  return svg;
}

}  // namespace

double log_position(double value, double low, double high) {
  return std::log(std::clamp(value, low, high) / low) / std::log(high / low);
}

std::string draw_log_axis(const FrameArea& area, double low, double high, const std::string& label) {
  std::string svg;
  for (double decade = std::pow(10.0, std::floor(std::log10(low))); decade <= high; decade *= 10) {
    for (const double step : {1.0, 2.0, 5.0}) {
      const double value = step * decade;
      if (value < low * 0.999 || value > high * 1.001) continue;
      const double y = area.bottom - log_position(value, low, high) * (area.bottom - area.top);
      svg += line(area.left, y, area.right, y, kGridColour);
      svg += text_at(area.left - 8, y + 4, "end", kTextColour, number_text(value));
    }
  }
  const double middle = (area.top + area.bottom) / 2;
  return svg + text_at(area.left - 48, middle, "middle", kTextColour, label,
                       " transform=\"rotate(-90 " + coordinate(area.left - 48) + " " + coordinate(middle) + ")\"");
}

std::string line_plot(const LinePlot& plot) {
  const Scale scale = make_scale(plot);
  std::string svg = open_svg(kPlotWidth, kHeight, plot.y_label + " over " + plot.x_label);
  svg += draw_log_axis(kArea, scale.low, scale.high, plot.y_label) + draw_frame_axis(plot.x, kArea) + legend(plot);
  svg += text_at((kArea.left + kArea.right) / 2, kHeight - 6, "middle", kTextColour, plot.x_label);
  for (const PlotSeries& series : plot.series) svg += curve(plot.x, scale, series);
  return svg + "</svg>\n";
}

std::string bar_chart(std::span<const Bar> bars) {
  constexpr double kRow = 34, kValue = 110;
  double longest = 0, label_width = 190;
  for (const Bar& bar : bars) {
    longest = std::max(longest, bar.value);
    label_width = std::max(label_width, kCharacterWidth * static_cast<double>(bar.label.size()) + 16);
  }
  std::string svg = open_svg(kPlotWidth, kRow * static_cast<double>(bars.size()) + 4, "bars");
  double y = 2;
  for (const Bar& bar : bars) {
    const double length = longest > 0 ? std::max(2.0, bar.value / longest * (kPlotWidth - label_width - kValue)) : 2;
    svg += text_at(label_width - 12, y + 21, "end", kStrongTextColour, bar.label);
    svg += rectangle(label_width, y + 5, length, kRow - 10, bar.colour);
    svg += text_at(label_width + length + 10, y + 21, "start", kStrongTextColour, bar.text);
    y += kRow;
  }
  return svg + "</svg>\n";
}

std::string colour_ramp(double x, double y, double width, double scale_mm) {
  constexpr double kBar = 14;
  constexpr int kSteps = 64, kTicks = 4;
  std::string svg;
  const double step = width / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const float t = (static_cast<float>(i) + 0.5f) / kSteps;
    svg += "<rect x=\"" + coordinate(x + i * step) + "\" y=\"" + coordinate(y) + "\" width=\"" +
           coordinate(step + 0.6) + "\" height=\"" + coordinate(kBar) + "\" shape-rendering=\"crispEdges\" fill=\"" +
           css_colour(heat_colour(t)) + "\"/>\n";
  }
  for (int i = 0; i <= kTicks; ++i) {
    const double at = x + i * width / kTicks;
    const std::string value = number_text(scale_mm * i / kTicks);
    svg += line(at, y + kBar, at, y + kBar + 5, kTextColour);
    svg += text_at(at, y + kBar + 18, "middle", kTextColour, i == kTicks ? value + " mm" : value);
  }
  return svg;
}

std::string colour_bar(double scale_mm) {
  constexpr double kBarWidth = 360, kMargin = 24;
  return open_svg(kBarWidth, 40, "colours from 0 to " + number_text(scale_mm) + " mm") +
         colour_ramp(kMargin, 2, kBarWidth - 2 * kMargin, scale_mm) + "</svg>\n";
}

double heat_scale(double largest) {
  if (!(largest > 0) || !std::isfinite(largest)) return 1;
  const double decade = std::pow(10.0, std::floor(std::log10(largest)));
  for (const double step : {1.0, 1.2, 1.6, 2.0, 2.4, 3.2, 4.0, 6.0, 8.0}) {
    if (largest <= step * decade * (1 + 1e-12)) return step * decade;
  }
  return 10 * decade;
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

}  // namespace bodyopt
