#include "proxy_viewer/compare/heat_scale.h"

#include <algorithm>
#include <cmath>

#include "proxy_viewer/state/view_settings.h"

namespace bodyopt {

double round_heat(double mm) {
  constexpr double kFinestAutomatic = 0.1;  // of what is equal, noise shall not glow
  constexpr double kRounding = 1.001;       // 5 mm in single precision are 5 mm
  const double wanted = std::clamp(mm, kFinestAutomatic, kCoarsestHeat);
  const double power = std::pow(10, std::floor(std::log10(wanted * kRounding)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power * kRounding >= wanted) return step * power;
  }
  return 10 * power;
}

double HeatScale::choose(std::optional<double> p99_mm, bool playing) {
  if (!p99_mm) return mm_;
  const double mm = round_heat(*p99_mm);
  mm_ = playing && is_chosen_ ? std::max(mm_, mm) : mm;
  is_chosen_ = true;
  return mm_;
}

}  // namespace bodyopt
