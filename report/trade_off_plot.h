// Bytes against millimetres, as inline SVG.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dataset/results.h"

namespace bodyopt {

struct TradeOffPlot {
  std::vector<TradeOffPoint> curve;  // by rising bytes; two at least
  TradeOffPoint chosen;              // what was trained: bytes and expected error
  std::optional<double> heldout_mm;  // its RMS error, as measured on held-out frames
};

// Bytes from left to right, millimetres upwards on a logarithmic scale.
std::string trade_off_plot(const TradeOffPlot& plot);

}  // namespace bodyopt
