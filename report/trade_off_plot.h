// Bytes against millimetres, as inline SVG.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace bodyopt {

struct TradeOffPlot {
  struct Point {
    double bytes = 0, mm = 0;  // per vertex; RMS, > 0
  };
  std::vector<Point> curve;      // expected, by rising bytes; two at least
  Point chosen;                  // what was trained, as expected
  std::optional<Point> heldout;  // the same, as measured on held-out frames
};

// Bytes from left to right, millimetres upwards on a logarithmic scale.
std::string trade_off_plot(const TradeOffPlot& plot);

}  // namespace bodyopt
