// Sizes of loops of the jiggle that are worth a thread, and parts of arrays.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "runtime/core/executor.h"

namespace bodyopt::cpu {

// Multiply-adds, or as much. Threads that get less cost more to wake than they save.
inline constexpr std::size_t kPartWork = std::size_t{1} << 16;

// Elements of which each is that much work.
constexpr std::size_t grain_of(std::size_t work) { return std::max<std::size_t>(1, kPartWork / work); }

// The grain for `count` elements that are that much work together.
constexpr std::size_t grain_of(std::size_t count, std::size_t work) {
  return std::max<std::size_t>(1, count * kPartWork / std::max<std::size_t>(1, work));
}

// Multiply-adds of panels, or strips, of a block inverse.
template <typename Panel>
std::size_t work_of(std::span<const Panel> panels) {
  std::size_t work = 0;
  for (const Panel& panel : panels) work += std::size_t{panel.row_count} * panel.input_count;
  return work;
}

// The values of frame f of `frames`.
template <typename Values>
auto of_frame(Values& values, std::size_t f, std::size_t frames) {
  const std::size_t size = values.size() / frames;
  return std::span(values).subspan(f * size, size);
}

}  // namespace bodyopt::cpu
