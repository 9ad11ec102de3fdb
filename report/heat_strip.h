// Errors of every frame and region as colours: frames from left to right, a row per region.
#pragma once

#include <string>
#include <vector>

namespace bodyopt::report {

struct HeatStrip {
  std::vector<int> frames;                      // rising, one at least
  std::vector<double> whole_mm;                 // per frame, over the whole skin: the row on top
  std::vector<std::string> regions;             // names of the rows below
  std::vector<std::vector<double>> regions_mm;  // per frame, of every region
};

// An SVG file with frame numbers below and a scale in millimetres. Where there are more frames than fit, a column shows
// the worst of several. Throws Error(mismatch) when a row has another length than there are frames or names.
std::string heat_strip(const HeatStrip& strip);

}  // namespace bodyopt::report
