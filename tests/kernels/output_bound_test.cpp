#include <Eigen/Geometry>

#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "shaders/include/fold.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace output_bound_test {

struct Case {
  Case(std::uint32_t vertices, std::uint32_t frame_count)
      : random(vertices + 31 * frame_count),
        frames(frame_count),
        mesh(random_mesh(random, vertices)),
        push{vertices, static_cast<std::uint32_t>(mesh.triangles.size() / 3),
             box_count(static_cast<std::uint32_t>(mesh.triangles.size() / 3))},
        positions(random.floats(std::size_t{3} * vertices * frames, -1, 1)),
        boxes(std::size_t{6} * push.box_count * frames) {
    cpu::output_bound(mesh.triangles, push, positions, boxes);
  }

  Random random;
  std::uint32_t frames;
  MeshTable mesh;
  OutputBoundPush push;
  std::vector<float> positions, boxes;  // the last by the reference
};

const bool added = add_kernel_cases_of_frames("output_bound", "vertices", [](KernelSet& kernels, const Trial& trial) {
  const Case c(trial.size, trial.variant);
  return run_on<vulkan::OutputBound>(kernels, c.push, c.frames, {{c.boxes}}, c.mesh.triangles, c.positions);
});

TEST(OutputBoundReference, EqualsTheTextbook) {
  const Case c(200, 2);
  const std::size_t triangles = c.mesh.triangles.size() / 3;
  ASSERT_EQ(triangles, 400u);
  ASSERT_EQ(c.push.box_count, 54u);  // 50 of 8, and 4 of 128, the last of 16
  for (std::size_t f = 0; f < 2; ++f) {
    std::vector<Eigen::AlignedBox3f> boxes(54);
    for (std::size_t t = 0; t < triangles; ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Eigen::Vector3f corner =
            Eigen::Map<const Eigen::Vector3f>(&c.positions[600 * f + 3 * c.mesh.triangles[3 * t + k]]);
        boxes[t / 8].extend(corner);
        boxes[50 + t / 128].extend(corner);
      }
    }
    for (std::size_t b = 0; b < 54; ++b) {
      for (int i = 0; i < 3; ++i) {
        const std::size_t at = 6 * (54 * f + b) + static_cast<std::size_t>(i);
        ASSERT_EQ(c.boxes[at], boxes[b].min()[i]);
        ASSERT_EQ(c.boxes[at + 3], boxes[b].max()[i]);
      }
    }
  }
}

}  // namespace output_bound_test
}  // namespace bodyopt::testing
