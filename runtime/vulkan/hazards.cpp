#include "runtime/vulkan/hazards.h"

#include <algorithm>

namespace bodyopt::vulkan {
namespace {

bool overlap(const BufferRange& a, const BufferRange& b) {
  return a.buffer == b.buffer && a.offset < b.offset + b.size && b.offset < a.offset + a.size;
}

bool conflict(const BufferUse& a, const BufferUse& b) { return (a.writes || b.writes) && overlap(a.range, b.range); }

}  // namespace

bool Hazards::before(std::span<const BufferUse> next) const {
  return std::ranges::any_of(next, [&](const BufferUse& use) {
    return std::ranges::any_of(used_, [&](const BufferUse& earlier) { return conflict(earlier, use); });
  });
}

void Hazards::add(std::span<const BufferUse> uses) { used_.insert(used_.end(), uses.begin(), uses.end()); }

}  // namespace bodyopt::vulkan
