// Which recorded work has to wait for work before it: what is read must have been written, and what is written no
// longer be read.
#pragma once

#include <span>
#include <vector>

#include "runtime/vulkan/buffer.h"

namespace bodyopt::vulkan {

// What a kernel, copy or fill does with a range of a buffer.
struct BufferUse {
  BufferRange range;
  bool writes;
};

// Ranges that work without a barrier between has used. What one kernel or copy does with a range twice is no hazard.
class Hazards {
 public:
  // Whether work with these uses needs a barrier before it.
  bool before(std::span<const BufferUse> next) const;
  void add(std::span<const BufferUse> uses);
  void clear() { used_.clear(); }  // a barrier stands here

 private:
  std::vector<BufferUse> used_;
};

}  // namespace bodyopt::vulkan
