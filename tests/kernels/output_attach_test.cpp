#include "runtime/cpu/attach_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
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

}  // namespace output_attach_test
}  // namespace bodyopt::testing
