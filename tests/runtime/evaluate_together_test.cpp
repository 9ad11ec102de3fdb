// Calls of several deformers at once, of more frames than a batch has.
#include "runtime/deformer/evaluate_together.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "runtime/core/error.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/character_model.h"
#include "runtime/vulkan/backend/device_model.h"
#include "tests/support/cut_executor.h"
#include "tests/support/error_kind.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/random_tables.h"
#include "tests/support/small_basis.h"

namespace bodyopt::testing {
namespace evaluate_together_test {

// The second joint turns further with every frame.
std::vector<Pose> bending(const Basis& basis, std::size_t count) {
  std::vector<Pose> poses(count, bind_pose(basis.skeleton));
  for (std::size_t f = 0; f < count; ++f) {
    Quat& rotation = poses[f].joints[1].rotation;
    rotation = normalized(rotation * axis_angle({1, 0, 0}, 0.002 * static_cast<double>(f)));
  }
  return poses;
}

TEST(EvaluateTogether, GoesOnInFurtherBatches) {
  const Basis basis = small_basis();
  Deformer one(basis, {.name = "cpu"}), other(basis, {.name = "cpu"}), alone(basis, {.name = "cpu"});
  const std::vector<Pose> few = bending(basis, 3), many = bending(basis, 2 * one.batch_limit() + 2);
  Evaluation results[2];
  DeformerCall calls[] = {{.deformer = &one, .poses = few, .evaluation = &results[0]},
                          {.deformer = &other, .poses = many, .evaluation = &results[1]}};
  evaluate_together(calls);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(calls[k].error, nullptr);
    std::vector<float> frames;
    for (const Pose& pose : calls[k].poses) {
      const std::vector<float> positions = alone.evaluate({&pose, 1}).positions;
      frames.insert(frames.end(), positions.begin(), positions.end());
    }
    EXPECT_EQ(results[k].positions, frames);
    EXPECT_EQ(results[k].outside.size(), calls[k].poses.size());
  }
}

TEST(EvaluateTogether, OfOneDeformerTwiceIsRefused) {
  Deformer deformer(small_basis(), {.name = "cpu"});
  const std::vector<Pose> poses = bending(deformer.basis(), 1);
  Evaluation result;
  const DeformerCall call{.deformer = &deformer, .poses = poses, .evaluation = &result};
  DeformerCall twice[] = {call, call};
  EXPECT_EQ(kind_of([&] { evaluate_together(twice); }), ErrorKind::usage);
}

// The small basis with each output vertex `copies` times, on threads; a vertex has 14 numbers, between frames are 5.
struct Copies {
  explicit Copies(std::size_t copies) : basis(small_basis()) {
    const std::vector<std::uint32_t> once = basis.mesh.output_vertex;
    const std::vector<float> texture_of_one = Random(1).floats(2 * once.size(), 0, 1);
    basis.mesh.output_vertex.clear();
    std::vector<float> texture;
    for (std::size_t k = 0; k < copies; ++k) {
      basis.mesh.output_vertex.insert(basis.mesh.output_vertex.end(), once.begin(), once.end());
      texture.insert(texture.end(), texture_of_one.begin(), texture_of_one.end());
    }
    const std::vector<Pose> poses = bending(basis, kFrames);
    Deformer deformer(make_character_model(basis, std::nullopt, texture), std::nullopt,
                      {.name = "cpu", .executor = std::make_shared<CutExecutor>()});
    const std::size_t frame = kVertex * basis.mesh.output_count() + 5;
    placed.assign(kFrames * frame, 7.0f);
    const auto from = [&](std::size_t first) {
      return PlacedVertices{reinterpret_cast<std::byte*>(&placed[first]), kVertex * sizeof(float),
                            frame * sizeof(float)};
    };
    const SkinPlace place{.positions = from(1), .normals = from(4), .tangents = from(7)};
    Evaluation rest;
    DeformerCall call{.deformer = &deformer, .poses = poses, .evaluation = &rest, .place = &place};
    evaluate_together({&call, 1});
    const Evaluation whole = deformer.evaluate(poses);
    positions = whole.positions;
    normals = whole.normals;
  }

  std::span<const float> vertex(std::size_t f, std::size_t output) const {
    const std::size_t frame = kVertex * basis.mesh.output_count() + 5;
    return std::span(placed).subspan(f * frame + kVertex * output, kVertex);
  }

  static constexpr std::size_t kFrames = 3, kVertex = 14;
  Basis basis;
  std::vector<float> placed, positions, normals;
};

// More of them than a thread places at a time.
TEST(EvaluateTogether, PlacesManyVerticesAsFew) {
  constexpr std::size_t kCopies = 12;
  const Copies few(1), many(kCopies);
  const std::size_t outputs = few.basis.mesh.output_count();
  for (std::size_t f = 0; f < Copies::kFrames; ++f) {
    for (std::size_t o = 0; o < kCopies * outputs; ++o) {
      ASSERT_TRUE(std::ranges::equal(many.vertex(f, o), few.vertex(f, o % outputs))) << f << ' ' << o;
      const std::size_t at = 3 * (f * kCopies * outputs + o);
      ASSERT_TRUE(std::ranges::equal(std::span(many.positions).subspan(at, 3), many.vertex(f, o).subspan(1, 3)));
      ASSERT_TRUE(std::ranges::equal(std::span(many.normals).subspan(at, 3), many.vertex(f, o).subspan(4, 3)));
      ASSERT_EQ(std::abs(many.vertex(f, o)[10]), 1) << f << ' ' << o;  // the bitangent's sign
    }
  }
  for (const std::size_t first : {1, 4, 7}) {  // frames differ in each
    const auto numbers_of = [&](std::size_t f) { return few.vertex(f, 0).subspan(first, 3); };
    EXPECT_FALSE(std::ranges::equal(numbers_of(0), numbers_of(2))) << first;
  }
  EXPECT_FALSE(std::ranges::equal(few.vertex(0, 0), few.vertex(0, 1)));
  for (const std::size_t between : {0, 11, 12, 13}) EXPECT_EQ(many.vertex(2, outputs)[between], 7);
}

// On the device, as if it had little memory: batches are short.
Deformer in_short_batches(const Basis& basis) {
  const auto device = open_test_device();
  vulkan::DeviceInfo limits = device->info();
  limits.memory_bytes = 1 << 20;
  return Deformer(std::make_shared<const vulkan::DeviceModel>(device, make_character_model(basis), limits));
}

// While a device runs a batch the next is sent and the one before taken: each in memory of its own.
TEST(EvaluateTogether, BatchesUnderWayOnADeviceAreThoseAlone) {
  Basis untrained = small_basis();
  const std::size_t blocks = untrained.residual.blend_begin.size();
  untrained.strain = {};
  untrained.residual = {};
  untrained.residual.blend_begin.assign(blocks, 0);
  for (const Basis& basis : {small_basis(), untrained}) {
    Deformer deformer = in_short_batches(basis);
    const std::size_t outputs = basis.mesh.output_count(), limit = deformer.batch_limit();
    ASSERT_LE(limit, 32u);
    ASSERT_GT(limit, 1u);
    for (const std::size_t count : {5 * limit + 1, std::size_t{2}}) {
      const std::vector<Pose> poses = bending(basis, count);
      const Evaluation all = deformer.evaluate(poses);
      ASSERT_EQ(all.positions.size(), 3 * outputs * count);
      for (std::size_t f = 0; f < count; ++f) {
        const Evaluation alone = deformer.evaluate({&poses[f], 1});
        const auto of_frame = [&](const std::vector<float>& values) {
          return std::span(values).subspan(f * values.size() / count, values.size() / count);
        };
        ASSERT_TRUE(std::ranges::equal(of_frame(all.positions), alone.positions)) << f;
        ASSERT_TRUE(std::ranges::equal(of_frame(all.normals), alone.normals)) << f;
        ASSERT_TRUE(std::ranges::equal(of_frame(all.strains), alone.strains)) << f;
        ASSERT_EQ(all.outside[f], alone.outside[0]);
      }
      EXPECT_FALSE(
          std::ranges::equal(std::span(all.positions).first(3 * outputs), std::span(all.positions).last(3 * outputs)));
    }
  }
}

}  // namespace evaluate_together_test
}  // namespace bodyopt::testing
