#include "report/trade_off_plot.h"

#include <algorithm>
#include <cmath>

#include "report/plots.h"
#include "report/svg.h"

namespace bodyopt {
namespace {

constexpr double kTradeOffWidth = 960, kTradeOffHeight = 400;
constexpr FrameArea kTradeOffArea{.left = 62, .right = 946, .top = 20, .bottom = 350};
constexpr const char *kCurveColour = "#62aee8", *kChosenColour = "#f2b866", *kHeldoutColour = "#e8837a";

struct TradeOffScale {
  double first, last, low, high;

  double x(double bytes) const {
    return kTradeOffArea.left + (bytes - first) / (last - first) * (kTradeOffArea.right - kTradeOffArea.left);
  }
  double y(double mm) const {
    return kTradeOffArea.bottom - log_position(mm, low, high) * (kTradeOffArea.bottom - kTradeOffArea.top);
  }
};

TradeOffScale make_scale(const TradeOffPlot& plot) {
  std::vector<double> bytes{plot.chosen.bytes_per_vertex}, mm{plot.chosen.expected_mm};
  for (const TradeOffPoint& point : plot.curve) {
    bytes.push_back(point.bytes_per_vertex);
    mm.push_back(point.expected_mm);
  }
  if (plot.heldout_mm) mm.push_back(*plot.heldout_mm);
  const auto [first, last] = std::minmax_element(bytes.begin(), bytes.end());
  const auto [low, high] = std::minmax_element(mm.begin(), mm.end());
  const double margin = 0.04 * std::max(1.0, *last - *first);
  return {*first - margin, *last + margin, 0.8 * std::max(*low, 1e-4 * *high), 1.25 * std::max(*high, 1e-9)};
}

std::string byte_ticks(const TradeOffScale& scale) {
  const double step = round_up((scale.last - scale.first) / 10);
  std::string svg;
  for (double bytes = std::ceil(scale.first / step) * step; bytes <= scale.last; bytes += step) {
    const double x = scale.x(bytes);
    svg += line(x, kTradeOffArea.bottom, x, kTradeOffArea.bottom + 5, kTextColour);
    svg += text_at(x, kTradeOffArea.bottom + 19, "middle", kTextColour, number_text(bytes, 9));
  }
  return svg + text_at((kTradeOffArea.left + kTradeOffArea.right) / 2, kTradeOffHeight - 8, "middle", kTextColour,
                       "bytes per vertex");
}

std::string circle(double x, double y, double radius, const std::string& attributes) {
  return "<circle cx=\"" + coordinate(x) + "\" cy=\"" + coordinate(y) + "\" r=\"" + coordinate(radius) + "\" " +
         attributes + "/>\n";
}

std::string expected_curve(const TradeOffPlot& plot, const TradeOffScale& scale) {
  std::string path, dots;
  for (const TradeOffPoint& point : plot.curve) {
    const double x = scale.x(point.bytes_per_vertex), y = scale.y(point.expected_mm);
    path += (path.empty() ? "M" : "L") + coordinate(x) + " " + coordinate(y);
    dots += circle(x, y, 3, "fill=\"" + std::string(kCurveColour) + "\"");
  }
  return "<path d=\"" + path + "\" fill=\"none\" stroke=\"" + kCurveColour + "\" stroke-width=\"1.6\"/>\n" + dots;
}

// A mark whose words stand beside it, where the curve is not: above to the right, or below to the left.
std::string mark(double x, double y, const char* colour, const std::string& text, bool above) {
  const bool left = above ? x > kTradeOffArea.right - 300 : x > kTradeOffArea.left + 300;
  const double text_y = above ? y - 14 : y + 24;
  return circle(x, y, 6.5, "fill=\"none\" stroke-width=\"2.5\" stroke=\"" + std::string(colour) + "\"") +
         text_at(left ? x + (above ? 8 : 0) : x - (above ? 8 : 0), text_y, left ? "end" : "start", colour, text);
}

}  // namespace

std::string trade_off_plot(const TradeOffPlot& plot) {
  const TradeOffScale scale = make_scale(plot);
  std::string svg = open_svg(kTradeOffWidth, kTradeOffHeight, "RMS error over bytes per vertex");
  svg += draw_log_axis(kTradeOffArea, scale.low, scale.high, "RMS error, mm") + byte_ticks(scale);
  svg += expected_curve(plot, scale);
  const double x = scale.x(plot.chosen.bytes_per_vertex), expected = plot.chosen.expected_mm;
  const bool heldout_above = plot.heldout_mm && *plot.heldout_mm > expected;
  svg += mark(x, scale.y(expected), kChosenColour, "this basis, expected: " + number_text(expected) + " mm",
              !heldout_above);
  if (plot.heldout_mm) {
    svg += mark(x, scale.y(*plot.heldout_mm), kHeldoutColour, "held out: " + number_text(*plot.heldout_mm) + " mm",
                heldout_above);
  }
  return svg + "</svg>\n";
}

}  // namespace bodyopt
