#include "dataset/results.h"

#include <nlohmann/json.hpp>

namespace bodyopt {

Json to_json(const MethodResult& method) {
  return {{"errors_mm", to_json(method.errors)},
          {"bytes_per_vertex", method.bytes_per_vertex},
          {"coefficients", method.coefficients},
          {"seconds", method.seconds}};
}

Json to_json(const TradeOffPoint& point) {
  return {{"bytes_per_vertex", point.bytes_per_vertex},
          {"expected_rms_mm", point.expected_mm},
          {"microseconds", point.microseconds},
          {"coefficients", point.coefficients}};
}

}  // namespace bodyopt
