#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace output_place_test {

// Numbers from `first` on; between an element's three and the next's, and between frames, numbers of others.
struct Layout {
  std::uint32_t first, element, frame_gap;
};

struct Case {
  Case(std::uint32_t seed, std::uint32_t vertices, std::uint32_t frame_count, Layout l)
      : random(seed), frames(frame_count), layout(l), mesh(random_mesh(random, vertices)) {
    if (vertices > 0) {  // seams, in an order of their own
      for (std::uint32_t k = 0; k < vertices / 3; ++k) mesh.output_vertex.push_back(random.below(vertices));
      std::ranges::reverse(mesh.output_vertex);
    }
    values = random.floats(std::size_t{3} * vertices * frames, -1, 1);
    frame = layout.element * mesh.output_count() + layout.frame_gap;
    before = random.floats(layout.first + std::size_t{frame} * frames, -1, 1);
    placed = before;
    for (std::size_t f = 0; f < frames; ++f) {
      const std::size_t numbers = std::size_t{3} * vertices;
      cpu::output_place(mesh.output_vertex, std::span(values).subspan(f * numbers, numbers),
                        layout.element * sizeof(float),
                        reinterpret_cast<std::byte*>(placed.data() + layout.first + f * frame));
    }
  }

  Random random;
  std::uint32_t frames, frame = 0;
  Layout layout;
  MeshTable mesh;
  std::vector<float> values, before;
  std::vector<float> placed;  // by the reference
};

constexpr Layout kLayouts[] = {{0, 3, 0}, {0, 8, 0}, {5, 8, 7}};

// Every layout with every number of frames. What is between is left.
const bool added =
    add_kernel_cases({"output_place",
                      "vertices",
                      "layout",
                      {kSizes.begin(), kSizes.end()},
                      {0, 1, 2, 3, 4, 5, 6, 7, 8},
                      [](KernelSet& kernels, const Trial& trial) {
                        const Layout& layout = kLayouts[trial.variant % std::size(kLayouts)];
                        const Case c(trial.seed(), trial.size, kFrames[trial.variant / std::size(kLayouts)], layout);
                        return run_on<vulkan::OutputPlace>(
                            kernels, {c.mesh.output_count(), trial.size, layout.first, layout.element, c.frame},
                            c.frames, {{.values = c.placed, .before = c.before}}, c.mesh.output_vertex, c.values);
                      }});

// Number by number, from the definition.
TEST(OutputPlaceReference, FollowsTheOutputVertices) {
  for (const Layout& layout : kLayouts) {
    const Case c(1, 100, 3, layout);
    std::vector<float> expected = c.before;
    for (std::size_t f = 0; f < 3; ++f) {
      for (std::size_t o = 0; o < c.mesh.output_vertex.size(); ++o) {
        for (std::size_t i = 0; i < 3; ++i) {
          expected[layout.first + f * c.frame + o * layout.element + i] =
              c.values[3 * (100 * f + c.mesh.output_vertex[o]) + i];
        }
      }
    }
    EXPECT_EQ(c.placed, expected);
  }
}

}  // namespace output_place_test
}  // namespace bodyopt::testing
