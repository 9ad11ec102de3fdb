// What a training came to, as its file, its tables and its report tell it.
#pragma once

#include <cstdint>
#include <string>

#include "dataset/compare.h"
#include "runtime/core/json.h"

namespace bodyopt {

// One method on the held-out frames.
struct MethodResult {
  std::string name;
  ErrorStatistics errors;
  double bytes_per_vertex = 0;     // of the tables a frame needs; on linear blending without what strains need of DDM
  std::uint32_t coefficients = 0;  // learned, per frame; 0 for skinning alone
  double seconds = 0;              // of training
};
// Errors, bytes, coefficients and seconds; neither its name nor its frames.
Json to_json(const MethodResult& method);

// One of the bases that a training could give.
struct TradeOffPoint {
  double bytes_per_vertex = 0;  // of all tables
  double expected_mm = 0;       // RMS that cross-validation on the training frames expects
  double microseconds = 0;      // of a frame, see docs/train.md
  std::uint32_t coefficients = 0;
};
Json to_json(const TradeOffPoint& point);

}  // namespace bodyopt
