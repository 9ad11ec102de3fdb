// Curves and bars as inline SVG for reports on a dark page.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "report/frame_axis.h"

namespace bodyopt {

struct PlotSeries {
  std::string label, colour;  // colour: CSS
  std::vector<double> y;      // one per x of the plot
  bool emphasised = false;    // drawn thicker
};

// Curves over frames on a logarithmic scale (values at or below zero sit on its lower edge). A line is broken where
// frames are missing or a take begins. Throws Error(mismatch) when a series has another length than the axis.
struct LinePlot {
  std::string x_label, y_label;
  FrameAxis x;
  std::vector<PlotSeries> series;
};
std::string line_plot(const LinePlot& plot);

struct Bar {
  std::string label, colour;
  double value = 0;  // >= 0, linear scale from 0
  std::string text;  // what is written at the bar's end
};
std::string bar_chart(std::span<const Bar> bars);

// The colours of heat_colour() from 0 to `scale_mm`, with ticks in millimetres: as an SVG, and as a part of one.
std::string colour_bar(double scale_mm);
std::string colour_ramp(double x, double y, double width, double scale_mm);

// Where a value between low and high (> 0) lies on a logarithmic scale: 0 to 1, clamped.
double log_position(double value, double low, double high);
// Lines across, and values at the left, of a logarithmic scale in an area; low and high as above.
std::string draw_log_axis(const FrameArea& area, double low, double high, const std::string& label);

// The smallest scale that is not below `largest` and whose quarters are short numbers; 1 where nothing is above 0.
double heat_scale(double largest);

// The smallest 1, 2 or 5 times a power of ten that is not below `value` (> 0): a scale that is easy to read.
double round_up(double value);

// A number with up to `digits` significant digits, without a needless exponent or trailing zeros.
std::string number_text(double value, int digits = 3);

}  // namespace bodyopt
