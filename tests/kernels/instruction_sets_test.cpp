// Every set of instructions that the processor has gives the same bits, those of one lane at a time too, at whatever
// addresses numbers stand.
#include "tests/support/instruction_sets.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <functional>
#include <limits>

#include "runtime/cpu/ddm_frames.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/cpu/kernels.h"
#include "tests/support/odd_addresses.h"
#include "tests/support/random_tables.h"
#include "tests/support/random_tets.h"
#include "tests/support/small_inverse.h"

namespace bodyopt::testing {
namespace instruction_sets_test {

constexpr std::uint32_t kJoints = 9;

std::vector<std::uint32_t> bits_of(std::span<const float> values) {
  std::vector<std::uint32_t> bits;
  for (const float value : values) bits.push_back(std::bit_cast<std::uint32_t>(value));
  return bits;
}

// Runs the kernel with each set in turn, into outputs that hold a NaN before; then again, those and its inputs at odd
// addresses.
template <typename... Inputs>
void expect_same_bits(std::size_t count, const std::function<void(std::span<float>)>& kernel, Inputs&... inputs) {
  std::vector<std::uint32_t> first;
  int sets = 0;
  for (const std::size_t odd : {0u, 1u}) {
    if (odd != 0) (move_to_odd_addresses(inputs), ...);
    sets += with_each_instruction_set([&](const std::string& name) {
      std::vector<float> values(count + 1, std::numeric_limits<float>::quiet_NaN());
      const auto outputs = std::span(values).subspan(odd, count);
      kernel(outputs);
      for (const float value : outputs) ASSERT_TRUE(std::isfinite(value)) << name;
      if (first.empty()) first = bits_of(outputs);
      EXPECT_EQ(bits_of(outputs), first) << name;
    });
  }
  EXPECT_GT(sets, 2);
}

struct Skin {
  explicit Skin(std::uint32_t vertex_count)
      : random(vertex_count),
        vertices(vertex_count),
        ddm(random_ddm(random, vertices, kJoints)),
        skinning(random_skinning(random, kJoints, 2, 2.5)),
        origins(random.floats(8, -100, 100)),
        displacements(random.floats(std::size_t{6} * vertices, -0.01, 0.01)) {}

  Random random;
  std::uint32_t vertices;
  DdmTable ddm;
  std::vector<float> skinning, origins, displacements;
};

TEST(InstructionSets, PoseSkin) {
  for (const std::uint32_t vertices : {1u, 15u, 16u, 17u, 1237u}) {
    SCOPED_TRACE(vertices);
    Skin skin(vertices);
    expect_same_bits(
        skin.displacements.size(),
        [&](std::span<float> positions) {
          cpu::pose_skin(skin.ddm, kJoints, skin.skinning, skin.origins, skin.displacements, positions);
        },
        skin.ddm, skin.skinning, skin.origins, skin.displacements);
  }
}

TEST(InstructionSets, VertexFrames) {
  Skin skin(700);
  std::vector<std::uint32_t> some;
  for (int k = 0; k < 300; ++k) some.push_back(skin.random.below(skin.vertices));
  expect_same_bits(
      12 * some.size(),
      [&](std::span<float> frames) { cpu::vertex_frames(skin.ddm, some, skin.skinning.data(), frames); }, skin.ddm,
      skin.skinning, some);
}

TEST(InstructionSets, ResidualBlend) {
  constexpr std::uint32_t kCoefficients = 90;
  for (const std::uint32_t vertices : {1u, 16u, 1237u}) {
    SCOPED_TRACE(vertices);
    Random random(vertices);
    ResidualTable table = random_residual(random, 20, 0, kCoefficients, vertices);
    std::vector<float> coefficients = random.floats(2 * kCoefficients, -1, 1);
    expect_same_bits(
        std::size_t{6} * vertices,
        [&](std::span<float> displacements) { cpu::residual_blend(table, coefficients, 2, 0.7f, displacements); },
        table, coefficients);
  }
}

TEST(InstructionSets, ModifyBlend) {
  for (const std::uint32_t vertices : {1u, 16u, 1237u}) {
    SCOPED_TRACE(vertices);
    Random random(vertices);
    const ResidualTable table = random_residual(random, 20, 0, 30, vertices);
    SkinModifiers modifiers;
    modifiers.blend_begin = table.blend_begin;
    modifiers.blend = table.blend;
    std::vector<float> weights = random.floats(30, -1, 1);
    const std::vector<float> before = random.floats(std::size_t{3} * vertices, -1, 1);
    expect_same_bits(
        before.size(),
        [&](std::span<float> displacements) {
          std::copy(before.begin(), before.end(), displacements.begin());
          cpu::modify_blend(modifiers, weights, 1, displacements);
        },
        modifiers, weights);
  }
}

TEST(InstructionSets, JiggleRotate) {
  for (const std::uint32_t nodes : {4u, 16u, 1237u}) {
    SCOPED_TRACE(nodes);
    Random random(nodes);
    TetTable tets = random_tets(random, nodes);
    std::vector<float> moved = random.floats(std::size_t{6} * nodes, -1, 1);
    expect_same_bits(
        std::size_t{18} * nodes, [&](std::span<float> rotations) { cpu::jiggle_rotate(tets, moved, 2, rotations); },
        tets, moved);
  }
}

// Of panels and strips that are whole, and that are not.
TEST(InstructionSets, BlockUpAndDown) {
  for (const std::uint32_t own : {1u, 15u, 37u}) {
    SCOPED_TRACE(own);
    Random random(own);
    BlockInverse inverse = SmallInverse(random, own).inverse;
    std::vector<float> slots = random.floats(std::size_t{3} * inverse.slot_count(), -1, 1);
    const std::vector<float> known = random.floats(std::size_t{3} * inverse.unknown_count, -1, 1);
    for (std::size_t level = 0; level < inverse.levels.size(); ++level) {
      expect_same_bits(
          slots.size(),
          [&](std::span<float> results) {
            std::copy(slots.begin(), slots.end(), results.begin());
            cpu::block_up(inverse, inverse.levels[level], slots, 3, results);
          },
          inverse, slots);
      expect_same_bits(
          known.size(),
          [&](std::span<float> solutions) {
            std::copy(known.begin(), known.end(), solutions.begin());
            cpu::block_down(inverse, inverse.levels[level], slots, 3, 3, solutions);
          },
          inverse, slots);
    }
  }
}

// From features to coefficients, over regions of all sizes.
TEST(InstructionSets, Residual) {
  constexpr std::uint32_t kFrames = 2;
  Random random(5);
  ResidualTable table = random_residual(random, 23, 300, 200, 0);
  std::vector<float> features = random.floats(kFrames * table.feature_count(), -2, 2),
                     coordinates = random.floats(kFrames * table.coordinate_count(), -3, 3),
                     kernels = random.floats(kFrames * table.centre_count(), 0, 1),
                     rest = random.floats(table.coefficient_count(), -1, 1),
                     fades = random.floats(kFrames * table.regions.size(), 0, 1);
  const auto project = [&](std::span<float> to) { cpu::residual_project(table, features, kFrames, to); };
  const auto kernel = [&](std::span<float> to) { cpu::residual_kernels(table, coordinates, kFrames, to); };
  const auto coefficients = [&](std::span<float> to) {
    cpu::residual_coefficients(table, coordinates, kernels, rest, fades, kFrames, to);
  };
  expect_same_bits(coordinates.size(), project, table, features);
  expect_same_bits(kernels.size(), kernel, table, coordinates);
  expect_same_bits(kFrames * rest.size(), coefficients, table, coordinates, kernels, rest, fades);
}

// The kernel's own exponential, at and near the centre, far from it, and where it is no number any more.
TEST(InstructionSets, KernelsAreWithinTwoUlpOfTheTextbook) {
  ResidualTable table;
  Region region{};
  region.coordinate_count = region.centre_count = 1;
  region.inverse_width2 = 1;
  table.regions = {region};
  table.coordinate_region = table.centre_region = {0};
  table.centres = {0};
  for (double distance = 0; distance < 30; distance += 0.003) {
    const std::vector<float> coordinate = {static_cast<float>(distance)};
    float kernel = -1;
    cpu::residual_kernels(table, coordinate, 1, {&kernel, 1});
    const float square = coordinate[0] * coordinate[0];
    const double expected = square < 87 ? std::exp(-static_cast<double>(square)) : 0;
    ASSERT_NEAR(kernel, expected, 2 * 1.2e-7 * expected) << square;
  }
}

}  // namespace instruction_sets_test
}  // namespace bodyopt::testing
