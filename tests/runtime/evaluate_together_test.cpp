// Calls of several deformers at once, of more frames than a batch has.
#include "runtime/deformer/evaluate_together.h"

#include "runtime/core/error.h"
#include "runtime/deformer/deformer.h"
#include "tests/support/error_kind.h"
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
  const DeformerCall calls[] = {{.deformer = &one, .poses = few}, {.deformer = &other, .poses = many}};
  const std::vector<CallOutcome> outcomes = evaluate_together(calls);
  ASSERT_EQ(outcomes.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(outcomes[k].error, nullptr);
    std::vector<float> frames;
    for (const Pose& pose : calls[k].poses) {
      const std::vector<float> positions = alone.evaluate({&pose, 1}).positions;
      frames.insert(frames.end(), positions.begin(), positions.end());
    }
    EXPECT_EQ(outcomes[k].evaluation.positions, frames);
    EXPECT_EQ(outcomes[k].evaluation.outside.size(), calls[k].poses.size());
  }
}

TEST(EvaluateTogether, OfOneDeformerTwiceIsRefused) {
  Deformer deformer(small_basis(), {.name = "cpu"});
  const std::vector<Pose> poses = bending(deformer.basis(), 1);
  const DeformerCall call{.deformer = &deformer, .poses = poses};
  const DeformerCall twice[] = {call, call};
  EXPECT_EQ(kind_of([&] { evaluate_together(twice); }), ErrorKind::usage);
}

}  // namespace evaluate_together_test
}  // namespace bodyopt::testing
