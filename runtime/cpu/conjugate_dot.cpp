#include <algorithm>

#include "runtime/cpu/dynamics_kernels.h"

namespace bodyopt::cpu {

void conjugate_dot(std::span<const float> a, std::span<const float> b, std::span<float> sum) {
  float parts[kWorkgroupSize] = {};
  for (std::size_t first = 0; first < a.size(); first += kWorkgroupSize) {
    const std::size_t lanes = std::min<std::size_t>(kWorkgroupSize, a.size() - first);
    for (std::size_t lane = 0; lane < lanes; ++lane) parts[lane] += a[first + lane] * b[first + lane];
  }
  for (std::size_t half_size = kWorkgroupSize / 2; half_size > 0; half_size /= 2) {
    for (std::size_t lane = 0; lane < half_size; ++lane) parts[lane] += parts[lane + half_size];
  }
  sum[0] = parts[0];
}

}  // namespace bodyopt::cpu
