#include "cli/results/level_table.h"

#include <nlohmann/json.hpp>

#include "trainer/proxy/build_proxy.h"

namespace bodyopt::cli {

Json levels_info(const std::vector<Level>& levels, const ProxyReport& report) {
  Json list = Json::array();
  for (std::size_t k = 0; k < std::min(levels.size(), report.levels.size()); ++k) {
    const FrameTime time = frame_time(levels[k]);
    list.push_back({{"level", k}});
    list.back().update(to_json(report.levels[k]));
    list.back().update({{"coefficients", levels[k].basis.residual.coefficient_count()},
                        {"measured_on", report.measured_on},
                        {"microseconds", time.microseconds},
                        {"carrying_microseconds", time.carrying},
                        {"threads", time.threads}});
  }
  return list;
}

std::string level_table(const Json& levels) {
  if (levels.empty()) return "";
  std::string text =
      format("{:>5} {:>9} {:>9} {:>18} {:>9} {:>9} {:>9} {:>9} {:>9} {:>11} {:>11}\n", "level", "vertices", "error mm",
             "rest RMS, max mm", "RMS mm", "p99 mm", "max mm", "kilobytes", "with map", "us a frame", "carried");
  for (const Json& level : levels) {
    const auto number = [&](const char* key) { return level.at(key).get<double>(); };
    text += format("{:5} {:9} {:9.2f} {:9.2f} {:8.2f} {:9.3f} {:9.2f} {:9.1f} {:9.0f} {:9.0f} {:11.0f} {:11.0f}\n",
                   level.at("level").get<unsigned>(), level.at("vertices").get<unsigned>(), number("error_mm"),
                   number("distance_rms_mm"), number("distance_max_mm"), number("rms_mm"), number("p99_mm"),
                   number("max_mm"), number("bytes") / 1e3, (number("bytes") + number("map_bytes")) / 1e3,
                   number("microseconds"), number("microseconds") + number("carrying_microseconds"));
  }
  return text + format(
                    "RMS, p99, max: carried to the full skin, on {}; with map, carried: with what that takes; us: "
                    "on this machine's CPU, {} threads\n",
                    levels[0].at("measured_on").get<std::string>(), levels[0].at("threads").get<int>());
}

}  // namespace bodyopt::cli
