#include <Eigen/Dense>

#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
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

  Random random;
  std::uint32_t frames;
  MeshTable mesh;
  std::vector<float> positions;
  std::vector<float> normals;  // by the reference
};

const bool added = add_kernel_cases_of_frames("output_normals", "vertices", [](KernelSet& kernels, const Trial& trial) {
  const Case c(trial.size, trial.variant);
  return run_on<vulkan::OutputNormals>(kernels, {trial.size}, c.frames, {{c.normals}}, c.mesh.triangles,
                                       c.mesh.vertex_triangle_begin, c.mesh.vertex_triangles, c.positions);
});

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
