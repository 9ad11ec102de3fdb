#include <cstring>

#include "runtime/cpu/kernels.h"

namespace bodyopt::cpu {

void output_place(std::span<const std::uint32_t> output_vertex, std::span<const float> values,
                  std::size_t element_stride, std::byte* placed) {
  for (const std::uint32_t v : output_vertex) {
    std::memcpy(placed, &values[3 * std::size_t{v}], 3 * sizeof(float));
    placed += element_stride;
  }
}

}  // namespace bodyopt::cpu
