#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "runtime/cpu/attach_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_attached.h"
#include "tests/support/textbook_ddm.h"

namespace bodyopt::testing {
namespace output_anchor_test {

constexpr std::uint32_t kCorners = 70;

struct Case : RandomAttached {
  Case(std::uint32_t anchors, std::uint32_t frame_count)
      : RandomAttached(anchors + 31 * frame_count, frame_count, kCorners, anchors, 0),
        results(std::size_t{kAnchorNumbers} * anchors * frame_count) {
    // Skin that turned as a whole, and is stretched by up to a fifth.
    const std::vector<float> turns = random_skinning(random, 1, frames, 3);
    for (std::size_t k = 0; k < std::size_t{kCorners} * frames * kStretchNumbers; ++k) {
      const std::size_t i = k % kStretchNumbers;
      const float turned = turns[12 * (k / (kStretchNumbers * kCorners)) + 4 * (i / 3) + i % 3];
      stretches.push_back(turned + static_cast<float>(random.uniform(-0.2, 0.2)));
    }
    run();
  }

  void run() {
    for (std::size_t f = 0; f < frames; ++f) {
      cpu::output_anchor(tables, of_frame(stretches, f, std::size_t{kStretchNumbers} * kCorners),
                         of_frame(positions, f, std::size_t{3} * kSkin), of_frame(skinning, f, 12 * kJoints),
                         &origins[4 * f], of_frame(results, f, std::size_t{kAnchorNumbers} * anchor_count));
    }
  }

  std::vector<float> stretches;
  std::vector<float> results;  // by the reference
};

const bool added = add_kernel_cases_of_frames("output_anchor", "anchors", [](KernelSet& kernels, const Trial& trial) {
  const Case c(trial.size, trial.variant);
  return run_on<vulkan::OutputAnchor>(kernels, {trial.size, kCorners, Case::kSkin, Case::kJoints}, c.frames,
                                      {{c.results}}, c.tables.anchors, c.tables.points, c.tables.corners, c.stretches,
                                      c.positions, c.skinning, c.origins);
});

using Matrix = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;

TEST(OutputAnchorReference, EqualsTheTextbook) {
  const Case c(200, 2);
  std::size_t on_joints = 0;
  for (std::size_t k = 0; k < std::size_t{2} * c.anchor_count; ++k) {
    const std::size_t f = k / c.anchor_count;
    const AttachAnchor& anchor = c.tables.anchors[k % c.anchor_count];
    const auto joint = Eigen::Map<const Eigen::Matrix<float, 3, 4, Eigen::RowMajor>>(
                           c.skinning.data() + 12 * (f * Case::kJoints + anchor.joint))
                           .cast<double>();
    Eigen::Matrix3d turn = joint.leftCols<3>();
    Eigen::Vector3d centre = joint * Eigen::Vector4d(anchor.x, anchor.y, anchor.z, 1) +
                             Eigen::Map<const Eigen::Vector3f>(c.origins.data() + 4 * f).cast<double>();
    if (anchor.point_begin < anchor.point_end) {
      Eigen::Matrix3d sum = 1e-6 * turn;
      centre.setZero();
      for (std::uint32_t p = anchor.point_begin; p < anchor.point_end; ++p) {
        const SurfacePoint& point = c.tables.points[p];
        for (const auto& [corner, weight] : {std::pair{point.a, point.wa}, {point.b, point.wb}, {point.c, point.wc}}) {
          const double w = static_cast<double>(weight);
          sum +=
              w *
              Eigen::Map<const Matrix>(c.stretches.data() + kStretchNumbers * (f * kCorners + corner)).cast<double>();
          centre += w * Eigen::Map<const Eigen::Vector3f>(c.positions.data() +
                                                          3 * (f * Case::kSkin + c.tables.corners[corner].vertex))
                            .cast<double>();
        }
      }
      turn = nearest_rotation(sum);
    } else {
      ++on_joints;
    }
    const float* const found = c.results.data() + kAnchorNumbers * k;
    ASSERT_LT((Eigen::Map<const Matrix>(found).cast<double>() - turn).cwiseAbs().maxCoeff(), 3e-6) << k;
    ASSERT_LT((Eigen::Map<const Eigen::Vector3f>(found + 9).cast<double>() - centre).cwiseAbs().maxCoeff(), 3e-6) << k;
  }
  EXPECT_GT(on_joints, 50u);
}

// Skin that has no extent any more says nothing: anchors turn with their joints.
TEST(OutputAnchorReference, CollapsedSkinTurnsWithTheJoint) {
  Case c(50, 1);
  std::ranges::fill(c.stretches, 0.0f);
  c.run();
  for (std::size_t k = 0; k < c.anchor_count; ++k) {
    const float* const joint = c.skinning.data() + 12 * c.tables.anchors[k].joint;
    for (std::size_t i = 0; i < 9; ++i) {
      EXPECT_NEAR(c.results[kAnchorNumbers * k + i], joint[4 * (i / 3) + i % 3], 1e-6) << k;
    }
  }
}

}  // namespace output_anchor_test
}  // namespace bodyopt::testing
