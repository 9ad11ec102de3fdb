#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace output_place_test {

// Numbers from `first` on; between an element's three and the next's, and between frames, numbers of others.
struct Layout {
  std::uint32_t first, element, frame_gap;
};

struct Case {
  Case(std::uint32_t vertices, std::uint32_t frame_count, Layout l)
      : random(vertices + 31 * frame_count), frames(frame_count), layout(l), mesh(random_mesh(random, vertices)) {
    if (vertices > 0) {  // seams, in an order of their own
      for (std::uint32_t k = 0; k < vertices / 3; ++k) mesh.output_vertex.push_back(random.below(vertices));
      std::ranges::reverse(mesh.output_vertex);
    }
    values = random.floats(std::size_t{3} * vertices * frames, -1, 1);
    frame = layout.element * mesh.output_count() + layout.frame_gap;
    before = random.floats(layout.first + std::size_t{frame} * frames, -1, 1);
    placed = before;
    cpu::output_place(mesh, values, layout.element * sizeof(float), frame * sizeof(float),
                      reinterpret_cast<std::byte*>(placed.data() + layout.first));
  }

  Random random;
  std::uint32_t frames, frame = 0;
  Layout layout;
  MeshTable mesh;
  std::vector<float> values, before;
  std::vector<float> placed;  // by the reference
};

constexpr Layout kLayouts[] = {{0, 3, 0}, {0, 8, 0}, {5, 8, 7}};

class OutputPlace : public GpuTest {};

TEST_F(OutputPlace, EqualsTheReferenceAndLeavesTheRest) {
  const vulkan::OutputPlace kernel(*device_);
  for (const std::uint32_t vertices : kSizes) {
    for (const std::uint32_t frames : kFrames) {
      for (const Layout& layout : kLayouts) {
        SCOPED_TRACE(std::to_string(vertices) + " vertices, " + std::to_string(frames) + " frames, " +
                     std::to_string(layout.element) + " numbers apart");
        const Case c(vertices, frames, layout);
        const auto output_vertex = vulkan::upload(*device_, c.mesh.output_vertex, "output vertices"),
                   values = vulkan::upload(*device_, c.values, "values"),
                   before = vulkan::upload(*device_, c.before, "before");
        const auto outputs = run_kernel(*device_, {c.before.size()}, [&](auto& commands, const auto& out) {
          commands.copy({before, 0, sizeof(float) * c.before.size()}, out[0]);
          kernel.record(commands, {output_vertex, values, out[0]},
                        {c.mesh.output_count(), vertices, layout.first, layout.element, c.frame}, frames);
        });
        EXPECT_EQ(outputs[0], c.placed);
      }
    }
  }
}

// Number by number, from the definition.
TEST_F(OutputPlace, ReferenceFollowsTheOutputVertices) {
  for (const Layout& layout : kLayouts) {
    const Case c(100, 3, layout);
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
