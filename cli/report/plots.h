// Inline SVG for reports on a dark page. All text is escaped; colours and fonts are set here alone.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace bodyopt {

struct PlotSeries {
  std::string label, colour;  // colour: CSS
  std::vector<double> y;      // one per x of the plot
  bool emphasised = false;    // drawn thicker
};

// Curves over frames on a logarithmic scale (values at or below zero sit on its lower edge). A line is broken where
// frames are farther apart than usual. Throws Error(mismatch) when a series has another length than x.
struct LinePlot {
  std::string x_label, y_label;
  std::vector<int> x;  // ascending
  std::vector<PlotSeries> series;
};
std::string line_plot(const LinePlot& plot);

struct Bar {
  std::string label, colour;
  double value = 0;  // >= 0, linear scale from 0
  std::string text;  // what is written at the bar's end
};
std::string bar_chart(std::span<const Bar> bars);

// The colours of heat_colour() from 0 to `scale_mm`, with ticks in millimetres.
std::string colour_bar(double scale_mm);

// The smallest 1, 2 or 5 times a power of ten that is not below `value` (> 0): a scale that is easy to read.
double round_up(double value);

// A number with up to `digits` significant digits, without a needless exponent or trailing zeros.
std::string number_text(double value, int digits = 3);

std::string escape_html(const std::string& text);

}  // namespace bodyopt
