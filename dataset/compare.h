// Errors between two shape sequences: RMS, 99th percentile, maximum and jitter, in millimetres.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "runtime/core/json.h"

namespace bodyopt {

struct ErrorStatistics {
  double rms = 0, p99 = 0, max = 0;  // of the vertex distances, mm
  double jitter = 0;                 // RMS second difference of the error vectors over consecutive frames, mm
  std::uint32_t worst_frame = 0;     // sample index
  std::uint32_t worst_vertex = 0;
  std::vector<double> frame_rms;  // per sample, mm
  std::vector<double> frame_max;  // per sample, mm
};
// {"rms", "p99", "max", "jitter"}, mm.
Json to_json(const ErrorStatistics& errors);

// Fed sample by sample, in time order. `frame` numbers tell which samples are consecutive (jitter skips gaps).
class ErrorAccumulator {
 public:
  explicit ErrorAccumulator(std::uint32_t vertex_count);
  // a, b: vertex_count x 3, metres.
  void add(int frame, std::span<const float> a, std::span<const float> b);
  [[nodiscard]] ErrorStatistics finish() const;

 private:
  std::uint32_t vertex_count_;
  std::vector<float> distances_;  // all vertex distances, mm
  std::vector<double> frame_rms_, frame_max_;
  std::vector<std::vector<float>> history_;  // the last two error fields
  std::vector<int> history_frames_;
  double jitter_sum_ = 0;
  std::size_t jitter_count_ = 0;
  double worst_ = -1;
  std::uint32_t worst_frame_ = 0, worst_vertex_ = 0;
};

// Results of a training, as its file, its tables and its report give them.

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
