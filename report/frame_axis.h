// Frames from left to right, a column each, take after take.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace bodyopt {

struct TakeStart {
  std::string name;
  std::size_t column = 0;  // its first
};

struct FrameAxis {
  std::vector<int> frames;       // of every column
  std::vector<TakeStart> takes;  // by column, the first at 0; none: all of one take
};

// Where an axis is drawn, SVG units; frame numbers stand below `bottom`.
struct FrameArea {
  double left, right, top, bottom;
};

// Middle of a column.
double column_x(const FrameAxis& axis, const FrameArea& area, std::size_t column);

// True where a column does not follow on the one before: it begins a take, or frames between them are missing.
std::vector<bool> gaps(const FrameAxis& axis);

// Frame numbers below; of several takes, the name above and a line where each begins.
std::string draw_frame_axis(const FrameAxis& axis, const FrameArea& area);

}  // namespace bodyopt
