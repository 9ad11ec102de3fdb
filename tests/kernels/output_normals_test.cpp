#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/kernels/windows.h"
#include "tests/support/fan_windows.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace output_normals_test {

struct Case {
  Case(std::uint32_t vertices, std::uint32_t frame_count)
      : random(vertices + 31 * frame_count),
        frames(frame_count),
        mesh(random_mesh(random, vertices)),
        positions(random.floats(std::size_t{3} * vertices * frames, -1, 1)),
        normals(positions.size()) {
    cpu::output_normals(mesh, positions, normals);
  }

  KernelRun on(KernelSet& kernels, const vulkan::DeviceInfo& limits) const {
    const vulkan::Device& device = kernels.device();
    struct Bound {
      vulkan::FanBuffers fans;
      vulkan::Buffer positions;
    };
    const auto bound =
        std::make_shared<const Bound>(Bound{vulkan::upload_together<vulkan::FanBuffers>(device, mesh, limits),
                                            vulkan::upload(device, positions, "positions")});
    return {{{normals}},
            [&kernel = kernels.get<vulkan::OutputNormals>(), bound, vertices = mesh.vertex_count(), frames = frames](
                vulkan::Commands& commands, const auto& outputs) {
              vulkan::record_output_normals(commands, kernel, {bound->fans, bound->positions, outputs[0]}, vertices,
                                            frames);
            }};
  }

  Random random;
  std::uint32_t frames;
  MeshTable mesh;
  std::vector<float> positions;
  std::vector<float> normals;  // by the reference
};

class OutputNormals : public GpuTest {};

const bool added = add_kernel_cases_of_frames("output_normals", "vertices", [](KernelSet& kernels, const Trial& trial) {
  return Case(trial.size, trial.variant).on(kernels, kernels.device().info());
});

TEST_F(OutputNormals, WindowsGiveTheSameBits) { expect_same_bits_through_windows_of_fans(*device_, Case(1237, 2)); }

// Scattered from triangles to vertices, in double precision.
TEST(OutputNormalsReference, EqualsTheTextbook) {
  const Case c(200, 2);
  for (std::uint32_t f = 0; f < c.frames; ++f) {
    const auto x = Eigen::Map<const Eigen::Matrix3Xf>(c.positions.data() + 600 * f, 3, 200).cast<double>();
    Eigen::Matrix3Xd sum = Eigen::Matrix3Xd::Zero(3, 200);
    Eigen::VectorXd area = Eigen::VectorXd::Zero(200);
    for (std::size_t t = 0; t < c.mesh.triangles.size(); t += 3) {
      const std::uint32_t* v = c.mesh.triangles.data() + t;
      const Eigen::Vector3d a = x.col(v[0]), b = x.col(v[1]), d = x.col(v[2]);
      const Eigen::Vector3d normal = (b - a).cross(d - a);
      for (int k = 0; k < 3; ++k) {
        sum.col(v[k]) += normal;
        area[v[k]] += normal.norm();
      }
    }
    for (int v = 0; v < 200; ++v) {
      const double length = sum.col(v).norm();
      for (int i = 0; i < 3; ++i) {
        const double expected = length > 1e-20 ? sum(i, v) / length : 0;
        const double bound = length > 1e-20 ? 1e-6 * area[v] / length : 0;
        ASSERT_NEAR(c.normals[static_cast<std::size_t>(600 * f) + static_cast<std::size_t>(3 * v + i)], expected, bound)
            << "vertex " << v;
      }
    }
  }
}

}  // namespace output_normals_test
}  // namespace bodyopt::testing
