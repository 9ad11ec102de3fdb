#include "runtime/basis/output_order.h"
#include "runtime/cpu/attach_kernels.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/carry_skin.h"
#include "runtime/host/device_choice.h"
#include "runtime/host/rig.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/paths.h"
#include "tests/support/random_attached.h"

namespace bodyopt::testing {
namespace output_attach_test {

// Numbers from `first` on; between a vertex' three and the next's, and between frames, numbers of others.
struct Layout {
  std::uint32_t first, element, frame_gap;
};
constexpr Layout kLayouts[] = {{0, 3, 0}, {5, 8, 7}};
constexpr std::uint32_t kAnchors = 40, kBefore = 10;  // the second: vertices of meshes before

const bool added = add_kernel_cases(
    {"output_attach",
     "vertices",
     "layout",
     {kSizes.begin(), kSizes.end()},
     {0, 1, 2, 3, 4, 5},
     [](KernelSet& kernels, const Trial& trial) {
       const Layout& layout = kLayouts[trial.variant % std::size(kLayouts)];
       RandomAttached c(trial.seed(), kFrames[trial.variant / std::size(kLayouts)], 0, kAnchors, kBefore + trial.size);
       const std::vector<float> anchors = c.random.floats(std::size_t{kAnchorNumbers} * kAnchors * c.frames, -1, 1);
       const std::uint32_t frame = layout.element * trial.size + layout.frame_gap;
       Expected expected{c.random.floats(layout.first + std::size_t{frame} * c.frames, -1, 1)};
       expected.before = expected.values;
       for (std::size_t f = 0; f < c.frames; ++f) {
         std::vector<float> attached(std::size_t{3} * trial.size);
         cpu::output_attach(c.tables, kBefore,
                            RandomAttached::of_frame(anchors, f, std::size_t{kAnchorNumbers} * kAnchors), attached);
         for (std::size_t k = 0; k < attached.size(); ++k) {
           expected.values[layout.first + f * frame + k / 3 * layout.element + k % 3] = attached[k];
         }
       }
       return run_on<vulkan::OutputAttach>(kernels,
                                           {kBefore, trial.size, kAnchors, layout.first, layout.element, frame},
                                           c.frames, {expected}, c.tables.vertices, anchors);
     }});

// All three kernels, one after the other, give what the host's carrier has in double precision, also far away.
TEST(OutputAttachReference, FollowsAsTheCarrierDoes) {
  const std::string folder = kSourceFolder + "/tests/old_files/";
  const Basis basis = load_basis(folder + "hero.safetensors");
  const Attachments attachments = load_attachments(folder + "hero.attached.safetensors", basis);
  const AttachTables tables = attach_tables(basis.mesh, attachments);
  const AttachmentCarrier carrier(basis, attachments);
  ASSERT_FALSE(tables.points.empty());
  for (const double away : {0.0, 100.0}) {
    Pose pose = bind_pose(basis.skeleton);
    for (std::size_t j = 0; j < pose.joints.size(); ++j) {
      pose.joints[j].rotation = pose.joints[j].rotation * axis_angle({0.6, 0, 0.8}, 0.4);
    }
    pose.joints[0].translation[0] += away;
    const std::vector<float> skin = Deformer(basis, DeviceChoice{.name = "cpu"}).evaluate({&pose, 1}).positions;
    const std::vector<float> positions = vertices_of(basis.mesh, skin);
    const RigFrame rig = pose_rig(basis.skeleton, pose);
    std::vector<float> stretches(kStretchNumbers * tables.corners.size()),
        frames(kAnchorNumbers * tables.anchors.size());
    cpu::output_stretch(tables, positions, stretches);
    cpu::output_anchor(tables, stretches, positions, rig.skinning, rig.origin, frames);
    const std::vector<std::vector<float>> expected = carrier.carry(skin, pose.joints);
    for (std::size_t m = 0; m < expected.size(); ++m) {
      std::vector<float> attached(expected[m].size());
      cpu::output_attach(tables, tables.vertex_begin[m], frames, attached);
      for (std::size_t k = 0; k < attached.size(); ++k) {
        ASSERT_NEAR(attached[k], expected[m][k], 1e-6 + 2e-7 * away) << m << ", " << k;
      }
    }
  }
}

}  // namespace output_attach_test
}  // namespace bodyopt::testing
