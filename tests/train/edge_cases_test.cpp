// Training where there is little to train on: no NaN, no crash, a basis that the runtime accepts.
#include <gtest/gtest.h>

#include "runtime/core/error.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/trained_basis.h"
#include "trainer/train/fit/train.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::trainer {
namespace {

// Trains, loads the basis into the runtime (which validates it) and evaluates the training frames.
double worst_error(const SampleSet& set) {
  Deformer deformer(trained_basis(set, {.components = 6, .centres = 12}), {.name = "cpu"});
  double worst = 0;
  for (const Sample& sample : set.train) {
    const Positions shape = welded_from_output(set.character, deformer.evaluate({&sample.pose, 1}).positions.data());
    EXPECT_TRUE(shape.allFinite());
    worst = std::max(worst, (shape - sample.shape.read()).rowwise().norm().maxCoeff());
  }
  return worst;
}

TEST(TrainEdgeCases, OneJointHasNoFeatures) {
  SampleSet set = limb_samples(20, 0);
  set.muscles.clear();
  set.character.skeleton.joints.resize(1);
  for (auto& weights : set.character.weights) weights = {{0, 1.0}};
  for (Sample& sample : set.train) {
    sample.pose.joints.resize(1);
    sample.pose.joints[0].rotation = axis_angle({0, 1, 0}, 0.1 * sample.frame);
    sample.shape = skin_linear(set.character, sample.pose);
  }
  EXPECT_LT(worst_error(set), 1e-6);
}

TEST(TrainEdgeCases, FramesThatAreAllTheSame) {
  SampleSet set = limb_samples(20, 0);
  for (Sample& sample : set.train) sample = set.train[7];
  EXPECT_LT(worst_error(set), 0.1);
}

TEST(TrainEdgeCases, FramesThatAreAllAtRest) {
  SampleSet set = limb_samples(20, 0);
  for (Sample& sample : set.train) {
    sample.pose = bind_pose(set.character.skeleton);
    sample.shape = set.character.vertices;
  }
  EXPECT_LT(worst_error(set), 1e-6);
}

TEST(TrainEdgeCases, ControlsTeachWhatThePoseDoesNot) {
  // The same pose throughout; a control inflates the limb.
  SampleSet set = limb_samples(40, 0);
  set.muscles.clear();
  set.controls = {"inflate"};
  for (Sample& sample : set.train) {
    const double inflate = 0.5 + 0.5 * std::sin(0.7 * sample.frame);
    sample.pose = bind_pose(set.character.skeleton);
    sample.pose.controls = {static_cast<float>(inflate)};
    Positions shape = set.character.vertices;
    shape.leftCols(2) *= 1 + 0.1 * inflate;
    sample.shape = shape;
  }
  EXPECT_LT(worst_error(set), 2e-4);
}

TEST(TrainEdgeCases, PaintedRegionsOfOneVertexAndOfAll) {
  SampleSet set = limb_samples(20, 0);
  set.regions = {{"dot", {5}, {1.0}}};
  EXPECT_LT(worst_error(set), 0.02);
  RegionWeights all{"all", {}, {}};
  for (std::uint32_t v = 0; v < set.character.vertices.rows(); ++v) all.vertices.push_back(v);
  all.weights.assign(all.vertices.size(), 1.0);
  set.regions = {all};
  EXPECT_LT(worst_error(set), 0.02);
}

TEST(TrainEdgeCases, LooseVerticesAndDegenerateTriangles) {
  SampleSet set = limb_samples(20, 0);
  Character& character = set.character;
  const auto count = static_cast<std::uint32_t>(character.vertices.rows());
  character.vertices.conservativeResize(count + 1, 3);
  character.vertices.row(count) << 0.3, 0.3, 0.3;
  character.weights.push_back({{1, 1.0}});
  character.output_vertex.push_back(count);
  character.triangles.conservativeResize(character.triangles.rows() + 1, 3);
  character.triangles.bottomRows(1) << 5, 5, 6;
  for (Sample& sample : set.train) sample.shape = limb_truth(character, set.muscles, sample.pose);
  EXPECT_LT(worst_error(set), 0.02);
}

TEST(TrainEdgeCases, RefusesShapesThatDoNotFit) {
  const auto kind = [](const SampleSet& set) {
    try {
      trained_basis(set, {});
    } catch (const Error& error) {
      return error.kind();
    }
    return ErrorKind::interrupted;
  };
  SampleSet set = limb_samples(20, 0);
  Positions shape = set.train[3].shape.read();
  shape(5, 1) = std::nan("");
  set.train[3].shape = shape;
  EXPECT_EQ(kind(set), ErrorKind::mismatch);
  set = limb_samples(20, 0);
  set.train[3].shape = Positions(shape.topRows(10));
  EXPECT_EQ(kind(set), ErrorKind::mismatch);
  set = limb_samples(20, 0);
  set.train[3].pose.joints.pop_back();
  EXPECT_EQ(kind(set), ErrorKind::mismatch);
  set = limb_samples(20, 0);
  set.train[3].pose.controls = {1};
  EXPECT_EQ(kind(set), ErrorKind::mismatch);
  set = limb_samples(20, 0);
  set.controls = {"unheard of"};
  EXPECT_EQ(kind(set), ErrorKind::mismatch);
}

}  // namespace
}  // namespace bodyopt::trainer
