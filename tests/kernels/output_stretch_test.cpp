#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "runtime/cpu/attach_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_attached.h"

namespace bodyopt::testing {
namespace output_stretch_test {

struct Case : RandomAttached {
  Case(std::uint32_t corners, std::uint32_t frame_count)
      : RandomAttached(corners + 31 * frame_count, frame_count, corners, 0, 0),
        stretches(std::size_t{kStretchNumbers} * corners * frame_count) {
    for (std::size_t f = 0; f < frames; ++f) {
      cpu::output_stretch(tables, of_frame(positions, f, std::size_t{3} * kSkin),
                          of_frame(stretches, f, std::size_t{kStretchNumbers} * corners));
    }
  }

  std::vector<float> stretches;  // by the reference
};

const bool added = add_kernel_cases_of_frames("output_stretch", "corners", [](KernelSet& kernels, const Trial& trial) {
  const Case c(trial.size, trial.variant);
  return run_on<vulkan::OutputStretch>(kernels, {trial.size, Case::kSkin}, c.frames, {{c.stretches}}, c.tables.corners,
                                       c.tables.fans, c.positions);
});

TEST(OutputStretchReference, EqualsTheTextbook) {
  const Case c(200, 2);
  for (std::size_t k = 0; k < std::size_t{2} * c.corner_count; ++k) {
    const AttachCorner& corner = c.tables.corners[k % c.corner_count];
    const auto x = Eigen::Map<const Eigen::Matrix3Xf>(
                       c.positions.data() + std::size_t{3} * Case::kSkin * (k / c.corner_count), 3, Case::kSkin)
                       .cast<double>();
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (std::uint32_t t = corner.fan_begin; t < corner.fan_end; ++t) {
      const AttachFan& fan = c.tables.fans[t];
      const Eigen::Vector3d b = x.col(fan.b) - x.col(corner.vertex), d = x.col(fan.c) - x.col(corner.vertex);
      sum += b * Eigen::RowVector3d(fan.bx, fan.by, fan.bz) + d * Eigen::RowVector3d(fan.cx, fan.cy, fan.cz);
      normal += b.cross(d);
    }
    sum += normal.normalized() * Eigen::RowVector3d(corner.normal_x, corner.normal_y, corner.normal_z);
    const auto found =
        Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(c.stretches.data() + kStretchNumbers * k);
    ASSERT_LT((found.cast<double>() - corner.share * sum).cwiseAbs().maxCoeff(), 3e-6) << k;
  }
}

}  // namespace output_stretch_test
}  // namespace bodyopt::testing
