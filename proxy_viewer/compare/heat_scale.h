// The error that is shown in the hottest colour, where the animator gives none.
#pragma once

#include <optional>

namespace bodyopt {

// The next 1, 2 or 5 times a power of ten, within what the scale can be set to.
double round_heat(double mm);

class HeatScale {
 public:
  // `p99_mm`: what 99 of 100 vertices are below; none: it is not known. Gives millimetres. While frames follow each
  // other they only rise: colours shall mean the same, but a clip may begin at rest, where nothing is off.
  double choose(std::optional<double> p99_mm, bool playing);

 private:
  double mm_ = 10;
  bool is_chosen_ = false;
};

}  // namespace bodyopt
