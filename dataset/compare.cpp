#include "dataset/compare.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/quantile.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr double kLargestDistance = 1e12;  // mm; squares of it still add up in double precision

}  // namespace

ErrorAccumulator::ErrorAccumulator(std::uint32_t vertex_count) : vertex_count_(vertex_count) {}

void ErrorAccumulator::add(int frame, std::span<const float> a, std::span<const float> b) {
  if (a.size() != 3 * std::size_t{vertex_count_} || b.size() != a.size()) {
    throw Error(ErrorKind::mismatch, "frame ", frame, ": shapes of ", a.size() / 3, " and ", b.size() / 3,
                " vertices are compared, expected ", vertex_count_, " each");
  }
  std::vector<float> error(a.size());
  double sum = 0, largest = 0;
  for (std::size_t v = 0; v < vertex_count_; ++v) {
    double distance2 = 0;
    for (std::size_t i = 3 * v; i < 3 * v + 3; ++i) {
      const double difference = 1e3 * (static_cast<double>(a[i]) - static_cast<double>(b[i]));
      error[i] = static_cast<float>(difference);
      distance2 += difference * difference;
    }
    const double distance = std::sqrt(distance2);
    if (!(distance <= kLargestDistance)) {
      throw Error(ErrorKind::mismatch, "frame ", frame, ": vertex ", v, " is ", distance,
                  " mm off, expected a finite distance: one of the shapes holds no numbers");
    }
    distances_.push_back(static_cast<float>(distance));
    sum += distance2;
    largest = std::max(largest, distance);
    if (distance > worst_) {
      worst_ = distance;
      worst_frame_ = static_cast<std::uint32_t>(frame_rms_.size());
      worst_vertex_ = static_cast<std::uint32_t>(v);
    }
  }
  frame_rms_.push_back(std::sqrt(sum / std::max(1u, vertex_count_)));
  frame_max_.push_back(largest);

  if (!history_frames_.empty() && history_frames_.back() != frame - 1) {
    history_.clear();
    history_frames_.clear();
  }
  if (history_.size() == 2) {
    for (std::size_t i = 0; i < error.size(); ++i) {
      const double second =
          static_cast<double>(error[i]) - 2 * static_cast<double>(history_[1][i]) + static_cast<double>(history_[0][i]);
      jitter_sum_ += second * second;
    }
    jitter_count_ += vertex_count_;
    history_.erase(history_.begin());
    history_frames_.erase(history_frames_.begin());
  }
  history_.push_back(std::move(error));
  history_frames_.push_back(frame);
}

ErrorStatistics ErrorAccumulator::finish() const {
  ErrorStatistics result;
  result.frame_rms = frame_rms_;
  result.frame_max = frame_max_;
  result.worst_frame = worst_frame_;
  result.worst_vertex = worst_vertex_;
  if (distances_.empty()) return result;
  double sum = 0;
  for (const float d : distances_) sum += static_cast<double>(d) * static_cast<double>(d);
  result.rms = std::sqrt(sum / static_cast<double>(distances_.size()));
  result.max = std::max(0.0, worst_);
  result.p99 = static_cast<double>(quantile(distances_, 0.99));
  if (jitter_count_ > 0) result.jitter = std::sqrt(jitter_sum_ / static_cast<double>(jitter_count_));
  return result;
}

Json to_json(const ErrorStatistics& errors) {
  return {{"rms", errors.rms}, {"p99", errors.p99}, {"max", errors.max}, {"jitter", errors.jitter}};
}

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
