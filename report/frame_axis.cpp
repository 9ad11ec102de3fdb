#include "report/frame_axis.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "report/plots.h"
#include "report/svg.h"

namespace bodyopt {
namespace {

bool begins_take(const FrameAxis& axis, std::size_t column) {
  return std::any_of(axis.takes.begin(), axis.takes.end(),
                     [&](const TakeStart& take) { return take.column == column; });
}

// Of every column the smallest step from one frame to the next in its take, 1 at least.
std::vector<int> usual_steps(const FrameAxis& axis) {
  std::vector<int> steps(axis.frames.size(), 1);
  for (std::size_t begin = 0, end = 0; begin < steps.size(); begin = end) {
    int step = std::numeric_limits<int>::max();
    for (end = begin + 1; end < steps.size() && !begins_take(axis, end); ++end) {
      step = std::min(step, axis.frames[end] - axis.frames[end - 1]);
    }
    if (end > begin + 1) std::fill(steps.data() + begin, steps.data() + end, step);
  }
  return steps;
}

// The first column of every take, and those whose frame is the first at or past a multiple of a round number.
std::vector<std::size_t> ticks(const FrameAxis& axis) {
  constexpr double kMost = 12;
  const std::vector<int> steps = usual_steps(axis);
  const auto multiple = [&](std::size_t column) {
    const double step = round_up(static_cast<double>(axis.frames.size()) / kMost * steps[column]);
    return std::floor(axis.frames[column] / step);
  };
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < axis.frames.size(); ++k) {
    if (k == 0 || begins_take(axis, k) || multiple(k) > multiple(k - 1)) found.push_back(k);
  }
  return found;
}

std::string take_names(const FrameAxis& axis, const FrameArea& area) {
  std::string svg;
  double free_from = area.left;
  const double half = (area.right - area.left) / (2 * static_cast<double>(axis.frames.size()));
  for (const TakeStart& take : axis.takes) {
    const double x = column_x(axis, area, take.column) - half;
    svg += line(x, area.top, x, area.bottom, kTextColour);
    const double width = kCharacterWidth * static_cast<double>(take.name.size());
    if (x < free_from || x + width > area.right) continue;
    svg += text_at(x + 3, area.top - 5, "start", kTextColour, take.name);
    free_from = x + width + 6;
  }
  return svg;
}

}  // namespace

double column_x(const FrameAxis& axis, const FrameArea& area, std::size_t column) {
  const double count = static_cast<double>(std::max<std::size_t>(1, axis.frames.size()));
  return area.left + (static_cast<double>(column) + 0.5) / count * (area.right - area.left);
}

std::vector<bool> gaps(const FrameAxis& axis) {
  const std::vector<int> steps = usual_steps(axis);
  std::vector<bool> result;
  for (std::size_t k = 0; k < axis.frames.size(); ++k) {
    result.push_back(k == 0 || begins_take(axis, k) || axis.frames[k] - axis.frames[k - 1] > steps[k]);
  }
  return result;
}

std::string draw_frame_axis(const FrameAxis& axis, const FrameArea& area) {
  constexpr double kRoom = 46;  // of a frame number
  std::string svg;
  if (axis.takes.size() > 1) svg += take_names(axis, area);
  double last = -kRoom;
  for (const std::size_t k : ticks(axis)) {
    const double x = column_x(axis, area, k);
    if (x < last + kRoom) continue;
    svg += line(x, area.bottom, x, area.bottom + 5, kTextColour);
    svg += text_at(x, area.bottom + 19, "middle", kTextColour, std::to_string(axis.frames[k]));
    last = x;
  }
  return svg;
}

}  // namespace bodyopt
