#include "dataset/compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

TEST(ErrorAccumulator, AConstantOffsetIsItsLengthWithoutJitter) {
  ErrorAccumulator accumulator(2);
  for (int frame = 1; frame <= 5; ++frame) {
    const float x = 0.1f * static_cast<float>(frame * frame);  // the motion itself must not count
    const std::vector<float> a = {x + 0.003f, 0.004f, 0, x + 0.003f, 0.004f, 0}, b = {x, 0, 0, x, 0, 0};
    accumulator.add(frame, a, b);
  }
  const ErrorStatistics errors = accumulator.finish();
  EXPECT_NEAR(errors.rms, 5, 1e-3);
  EXPECT_NEAR(errors.p99, 5, 1e-3);
  EXPECT_NEAR(errors.max, 5, 1e-3);
  EXPECT_NEAR(errors.jitter, 0, 1e-3);
  EXPECT_EQ(errors.frame_rms.size(), 5u);
}

// e = +1, -1, +1 mm: the second difference is 1 + 2 + 1 mm.
TEST(ErrorAccumulator, AFlickerOfOneMillimetreJittersByFour) {
  ErrorAccumulator accumulator(1);
  for (int frame = 0; frame < 8; ++frame) {
    const float e = frame % 2 == 0 ? 0.001f : -0.001f;
    accumulator.add(frame, std::array{0.0f, e, 0.0f}, std::array{0.0f, 0.0f, 0.0f});
  }
  EXPECT_NEAR(accumulator.finish().jitter, 4, 1e-4);
}

TEST(ErrorAccumulator, JitterSkipsGaps) {
  ErrorAccumulator accumulator(1);
  // Linear within 1..3 and within 10..12, with a jump between.
  for (const int frame : {1, 2, 3, 10, 11, 12}) {
    const float e = 0.001f * static_cast<float>(frame < 5 ? frame : -7 * frame);
    accumulator.add(frame, std::array{e, 0.0f, 0.0f}, std::array{0.0f, 0.0f, 0.0f});
  }
  EXPECT_NEAR(accumulator.finish().jitter, 0, 1e-3);
  ErrorAccumulator no_three(1);
  for (const int frame : {1, 2, 4, 5}) no_three.add(frame, std::array{1.0f, 0.0f, 0.0f}, std::array{0.0f, 0.0f, 0.0f});
  EXPECT_EQ(no_three.finish().jitter, 0);
}

// Against the definitions, written out plainly over all samples.
TEST(ErrorAccumulator, AgreesWithThePlainDefinitions) {
  constexpr std::uint32_t kVertices = 37;
  const std::vector<int> frames = {3, 4, 5, 6, 9, 10, 11, 20, 22, 23};
  std::mt19937 random(5);
  const auto uniform = [&] { return static_cast<float>(random() / 4294967296.0 - 0.5) * 0.02f; };
  std::vector<std::vector<float>> a, b;
  ErrorAccumulator accumulator(kVertices);
  for (const int frame : frames) {
    a.emplace_back();
    b.emplace_back();
    for (std::size_t i = 0; i < 3 * kVertices; ++i) {
      a.back().push_back(uniform());
      b.back().push_back(uniform());
    }
    accumulator.add(frame, a.back(), b.back());
  }
  std::vector<double> distances;
  std::map<int, std::vector<double>> error;
  double worst = 0;
  std::uint32_t worst_frame = 0, worst_vertex = 0;
  for (std::uint32_t k = 0; k < frames.size(); ++k) {
    for (std::uint32_t v = 0; v < kVertices; ++v) {
      double d2 = 0;
      for (std::size_t i = 3 * v; i < 3 * v + 3; ++i) {
        error[frames[k]].push_back(1e3 * (static_cast<double>(a[k][i]) - static_cast<double>(b[k][i])));
        d2 += error[frames[k]].back() * error[frames[k]].back();
      }
      distances.push_back(std::sqrt(d2));
      if (distances.back() > worst) {
        worst = distances.back();
        worst_frame = k;
        worst_vertex = v;
      }
    }
  }
  double sum = 0, jitter = 0;
  std::size_t count = 0;
  for (const double d : distances) sum += d * d;
  for (const int t : frames) {
    if (!error.contains(t - 1) || !error.contains(t + 1)) continue;
    for (std::size_t i = 0; i < 3 * kVertices; ++i) {
      jitter += std::pow(error[t + 1][i] - 2 * error[t][i] + error[t - 1][i], 2);
    }
    count += kVertices;
  }
  std::sort(distances.begin(), distances.end());
  const ErrorStatistics errors = accumulator.finish();
  EXPECT_NEAR(errors.rms, std::sqrt(sum / static_cast<double>(distances.size())), 1e-5);
  EXPECT_NEAR(errors.max, worst, 1e-5);
  EXPECT_EQ(errors.worst_frame, worst_frame);
  EXPECT_EQ(errors.worst_vertex, worst_vertex);
  EXPECT_NEAR(errors.jitter, std::sqrt(jitter / static_cast<double>(count)), 1e-5);
  const auto above = std::count_if(distances.begin(), distances.end(), [&](double d) { return d > errors.p99 + 1e-6; });
  EXPECT_GE(above, 2);  // of 370 distances, 1 % are 3.7
  EXPECT_LE(above, 4);
  EXPECT_NEAR(*std::max_element(errors.frame_max.begin(), errors.frame_max.end()), worst, 1e-5);
  double mean_square = 0;
  for (const double rms : errors.frame_rms) mean_square += rms * rms / static_cast<double>(frames.size());
  EXPECT_NEAR(std::sqrt(mean_square), errors.rms, 1e-5);
}

TEST(ErrorAccumulator, NothingGivesZeros) {
  const ErrorStatistics errors = ErrorAccumulator(5).finish();
  EXPECT_EQ(errors.rms, 0);
  EXPECT_EQ(errors.max, 0);
  EXPECT_EQ(errors.jitter, 0);
}

TEST(ErrorAccumulator, RefusesOtherCountsAndWhatIsNoNumber) {
  ErrorAccumulator accumulator(1);
  const std::array<float, 3> zero{};
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    EXPECT_THROW(accumulator.add(1, std::array{0.0f, bad, 0.0f}, zero), Error);
    EXPECT_THROW(accumulator.add(1, zero, std::array{0.0f, bad, 0.0f}), Error);
  }
  EXPECT_THROW(accumulator.add(1, std::array<float, 6>{}, zero), Error);
  EXPECT_THROW(accumulator.add(1, zero, std::array<float, 6>{}), Error);
}

}  // namespace
}  // namespace bodyopt
