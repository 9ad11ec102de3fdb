// An animated WebP, decoded.
#pragma once

#include <cstdint>
#include <vector>

namespace bodyopt {

struct DecodedAnimation {
  std::uint32_t width = 0, height = 0, loops = 1;
  std::vector<std::vector<std::uint8_t>> frames;  // height x width x 4 each
  std::vector<int> ends;                          // when each goes, milliseconds; none where it cannot be decoded
};

DecodedAnimation decode_animation(const std::vector<std::uint8_t>& bytes);

}  // namespace bodyopt
