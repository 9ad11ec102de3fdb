#include "viewport/scene/truth_times.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace bodyopt::viewport {
namespace {

// Tolerances are shares of a step, and of the place: caches keep their times in single precision.
constexpr double kOnSample = 1e-3, kRounding = 1e-7;

// Frames of a dataset stand for themselves: nothing lies between them.
std::optional<SampleTime> own_time(const std::vector<int>& frames, int frame) {
  const auto found = std::lower_bound(frames.begin(), frames.end(), frame);
  if (found == frames.end() || *found != frame) return std::nullopt;
  return SampleTime{static_cast<std::uint32_t>(found - frames.begin()), 0};
}

}  // namespace

std::optional<SampleTime> sample_time(const trainer::NamedShapes& truth, int frame) {
  if (!truth.frames().empty()) return own_time(truth.frames(), frame);
  const double step = std::max(1e-6, static_cast<double>(truth.sample_rate()));
  const double at = (frame - static_cast<double>(truth.start_frame())) / step, nearest = std::round(at);
  const double last = truth.sample_count() - 1.0;
  if (!(nearest >= 0 && nearest <= last)) return std::nullopt;
  const bool on_sample = std::abs(at - nearest) < kOnSample + kRounding * std::abs(at);
  if (on_sample) return SampleTime{static_cast<std::uint32_t>(nearest), 0};
  if (at < 0 || at > last) return std::nullopt;
  return SampleTime{static_cast<std::uint32_t>(at), static_cast<float>(at - std::floor(at))};
}

std::vector<float> read_sample(const trainer::NamedShapes& truth, const SampleTime& time) {
  std::vector<float> points = truth.sample(time.sample);
  if (time.on_sample()) return points;
  const std::vector<float> next = truth.sample(time.sample + 1);
  for (std::size_t k = 0; k < points.size(); ++k) points[k] += time.share * (next[k] - points[k]);
  return points;
}

std::string describe_truth_times(const std::string& file, const trainer::NamedShapes& truth, const Clip& clip) {
  if (!truth.frames().empty()) return {};
  const float first = truth.start_frame(), step = truth.sample_rate();
  const std::uint32_t count = truth.sample_count();
  if (first == static_cast<float>(clip.first_frame) && step == 1 && count == clip.poses.size()) return {};
  std::ostringstream text;
  text << file << ": " << count << " samples, of frames " << first << "-"
       << first + step * static_cast<float>(count - 1);
  if (step != 1) text << ", one every " << step << " frames";
  text << "; the clip has frames " << clip.first_frame << "-" << clip.last_frame() << " at " << clip.fps
       << " a second. Between two samples what lies on a straight line between them is shown, and nothing is measured; "
          "beyond the first and the last there is nothing to show. Was the cache written with another --fps, or of "
          "another part of the clip?";
  return text.str();
}

}  // namespace bodyopt::viewport
