#include <algorithm>
#include <vector>

#include "runtime/basis/dynamics.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/parallel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/cpu/jiggle_rotate.cpp"
#include "hwy/foreach_target.h"
// Below it: what is compiled again for each set of instructions.
#include "runtime/cpu/lane_rotation.h"

HWY_BEFORE_NAMESPACE();
namespace bodyopt::cpu::HWY_NAMESPACE {

// Rotates nodes `begin` to `end`. gradients: T x 9, each times the volume of its tet.
void rotate_lanes(const TetTable& tets, const float* gradients, std::size_t begin, std::size_t end, float* rotations) {
  for (std::size_t first = begin; first < end; first += kLaneCount) {
    const std::size_t count = std::min<std::size_t>(kLaneCount, end - first);
    float numbers[9][kLaneCount] = {};
    for (std::size_t lane = 0; lane < count; ++lane) {
      float sum[9] = {};
      for (std::uint32_t k = tets.corner_begin[first + lane]; k < tets.corner_begin[first + lane + 1]; ++k) {
        const float* gradient = gradients + std::size_t{9} * (tets.corners[k] / 4);
        for (std::size_t i = 0; i < 9; ++i) sum[i] += gradient[i];
      }
      for (std::size_t i = 0; i < 9; ++i) numbers[i][lane] = sum[i];
    }
    Lanes sums[9], r[9];
    for (std::size_t i = 0; i < 9; ++i) sums[i] = load_lanes(numbers[i]);
    rot(sums, r);  // the same for the sum as for the mean
    for (std::size_t i = 0; i < 9; ++i) store_lanes(r[i], numbers[i]);
    for (std::size_t lane = 0; lane < count; ++lane) {
      for (std::size_t i = 0; i < 9; ++i) rotations[9 * (first + lane) + i] = numbers[i][lane];
    }
  }
}

}  // namespace bodyopt::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace bodyopt::cpu {

HWY_EXPORT(rotate_lanes);

namespace {

// Deformation gradient of a tet: F = D(X) D^-1, row-major. nodes: N x 3 of the frame.
void deformation_gradient(const TetTable& tets, std::size_t tet, const float* nodes, float (&f)[9]) {
  const std::uint32_t* corners = tets.tets.data() + 4 * tet;
  const float* inverse = tets.shapes[tet].inverse_edges;
  const float* origin = nodes + std::size_t{3} * corners[0];
  float edges[9];
  for (std::size_t j = 0; j < 3; ++j) {
    const float* corner = nodes + std::size_t{3} * corners[1 + j];
    for (std::size_t i = 0; i < 3; ++i) edges[3 * i + j] = corner[i] - origin[i];
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      f[3 * i + k] = edges[3 * i] * inverse[k] + edges[3 * i + 1] * inverse[3 + k] + edges[3 * i + 2] * inverse[6 + k];
    }
  }
}

// A gradient is found once, not by each of the tet's four nodes.
void rotate_frame(const TetTable& tets, const float* nodes, std::vector<float>& gradients, float* rotations,
                  Executor& threads) {
  parallel_each(threads, tets.tet_count(), grain_of(64), [&](std::size_t tet) {
    float gradient[9];
    deformation_gradient(tets, tet, nodes, gradient);
    for (std::size_t i = 0; i < 9; ++i) gradients[9 * tet + i] = tets.shapes[tet].volume * gradient[i];
  });
  parallel_parts(threads, tets.node_count(), grain_of(512), [&](std::size_t begin, std::size_t end) {
    HWY_DYNAMIC_DISPATCH(rotate_lanes)(tets, gradients.data(), begin, end, rotations);
  });
}

}  // namespace

void jiggle_rotate(const TetTable& tets, std::span<const float> nodes, std::uint32_t frame_count,
                   std::span<float> rotations, Executor& threads) {
  const std::size_t count = tets.node_count();
  // Several frames go to threads whole: where cores share no cache, reading another's gradients takes longer.
  parallel_parts(threads, frame_count, 1, [&](std::size_t begin, std::size_t end) {
    thread_local std::vector<float> gradients;  // kept, as it is wanted every frame
    gradients.resize(std::size_t{9} * tets.tet_count());
    for (std::size_t f = begin; f < end; ++f) {
      rotate_frame(tets, nodes.data() + 3 * f * count, gradients, rotations.data() + 9 * f * count,
                   frame_count == 1 ? threads : calling_thread());
    }
  });
}

}  // namespace bodyopt::cpu
#endif
