// Training on a synthetic limb, from shapes to skin.
#include "trainer/train/fit/train.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/json_file.h"
#include "base/progress.h"
#include "dataset/regions_file.h"
#include "runtime/core/error.h"
#include "runtime/cpu/cpu_backend.h"
#include "runtime/cpu/kernels.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/rig.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/on_threads.h"
#include "tests/support/same_basis.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/trained_basis.h"
#include "trainer/train/judge/test_errors.h"
#include "trainer/train/pack/trade_off.h"
#include "trainer/train/skinning/ddm.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::trainer {
namespace train_test {

// RMS and largest distance of the deformer from samples, millimetres.
struct Distance {
  double rms = 0, max = 0;
};

Distance distance(const Basis& basis, const Character& character, const std::vector<Sample>& samples) {
  Deformer deformer(basis, {.name = "cpu"});
  Distance result;
  double sum = 0, count = 0;
  for (const Sample& sample : samples) {
    const Positions shape = welded_from_output(character, deformer.evaluate({&sample.pose, 1}).positions.data());
    const Eigen::VectorXd error = 1000 * (shape - sample.shape.read()).rowwise().norm();
    sum += error.squaredNorm();
    count += static_cast<double>(error.size());
    result.max = std::max(result.max, error.maxCoeff());
  }
  result.rms = std::sqrt(sum / count);
  return result;
}

const SampleSet& samples() {
  static const SampleSet set = limb_samples(160, 60);
  return set;
}

const Basis& full_basis() {
  static const Basis basis = trained_basis(samples(), {.centres = 100});
  return basis;
}

TEST(Train, BeatsDirectDeltaMushAndJointLinearOnHeldoutFrames) {
  const SampleSet& set = samples();
  const Basis& full = full_basis();
  const Distance learned = distance(full, set.character, set.heldout);
  const Distance ddm = distance(without_residual(full), set.character, set.heldout);
  // Given more bytes, which it cannot make use of.
  const Basis linear = trained_basis(
      set, {.components = 128, .method = {.strains = false, .kernels = false}, .budget = 2 * bytes_per_vertex(full)});
  const Distance joint_linear = distance(linear, set.character, set.heldout);
  RecordProperty("rms_mm", std::to_string(ddm.rms) + " DDM, " + std::to_string(joint_linear.rms) + " linear, " +
                               std::to_string(learned.rms) + " full");
  EXPECT_LE(learned.rms, 0.5 * ddm.rms);
  EXPECT_LT(learned.rms, joint_linear.rms);
}

TEST(Train, ReproducesTrainingFramesGivenEnoughComponentsAndCentres) {
  SampleSet set = samples();
  set.train.resize(60);
  const Basis basis = trained_basis(set, {.components = 60, .centres = 60});
  const Distance learned = distance(basis, set.character, set.train);
  RecordProperty("mm", std::to_string(learned.rms) + " rms, " + std::to_string(learned.max) + " max");
  EXPECT_LT(learned.rms, 0.05);
}

// A component answers to more directions of the features than one.
TEST(Train, AMapHasMoreCoordinatesThanComponents) {
  const Basis basis = trained_basis(samples(), {.components = 1, .centres = 12});
  EXPECT_LE(basis.residual.coefficient_count(), basis.residual.regions.size());
  EXPECT_GT(basis.residual.coordinate_count(), 2 * basis.residual.regions.size());
}

TEST(Train, RegionsThatWereWrittenGiveTheSameBasis) {
  const TemporaryFolder folder;
  SampleSet set = samples();
  set.train.resize(60);
  const TrainOptions options{.components = 6, .centres = 12};
  const std::vector<RegionWeights> regions = training_regions(set, options);
  const Basis automatic = trained_basis(set, options);
  write_regions(regions, set.character, folder / "regions.json");
  Dataset dataset;
  dataset.folder = folder.path();
  dataset.regions = "regions.json";
  set.regions = read_regions(dataset, set.character);
  const Basis edited = trained_basis(set, options);
  EXPECT_EQ(testing::difference(automatic, edited), "");
  const Json report = Json::parse(edited.metadata.at("report"));
  ASSERT_EQ(report["regions"].size(), regions.size());
  for (std::size_t r = 0; r < regions.size(); ++r) EXPECT_EQ(report["regions"][r]["name"], regions[r].name);
  // Another region makes another basis.
  set.regions.front().name = "mine";
  EXPECT_EQ(testing::difference(automatic, trained_basis(set, options)), "coverage");
  for (double& weight : set.regions.front().weights) weight *= 0.5;
  EXPECT_EQ(testing::difference(automatic, trained_basis(set, options)), "residual");
}

// Shapes that linear blending has made leave less to learn the less is smoothed.
TEST(Train, SmoothsLessWhereLinearBlendingLeavesLess) {
  SampleSet set = samples();
  set.train.resize(40);
  set.heldout = set.train;
  const std::vector<Positions> linear = heldout_by_lbs(set);
  for (std::size_t n = 0; n < linear.size(); ++n) set.train[n].shape = linear[n];
  const double usual = default_smoothing_radius(set.character.vertices);
  const TrainingResult result = train(set, {.components = 2, .centres = 4});
  EXPECT_LE(result.smoothing_radius, usual / 8);
  const Basis smoothed = build_ddm_basis(set.character, {.smoothing_radius = usual});
  const double left = distance(without_residual(result.basis), set.character, set.train).rms,
               left_by_usual = distance(smoothed, set.character, set.train).rms;
  EXPECT_LT(left, 0.5 * left_by_usual);
}

TEST(Train, RestIsRest) {
  Deformer deformer(full_basis(), {.name = "cpu"});
  const Character& character = samples().character;
  const Pose rest = bind_pose(character.skeleton);
  const Evaluation evaluation = deformer.evaluate({&rest, 1});
  const Positions skin = welded_from_output(character, evaluation.positions.data());
  EXPECT_LT((skin - character.vertices).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_EQ(evaluation.outside[0], 0);
}

TEST(Train, DisplacementAtRestIsExactlyZero) {
  const Basis& basis = full_basis();
  const std::unique_ptr<Backend> backend = make_cpu_backend(make_character_model(basis));
  const RigFrame rig = pose_rig(basis.skeleton, bind_pose(basis.skeleton));
  Batch batch;
  batch.frame_count = 1;
  batch.skinning = rig.skinning;
  batch.origins = {rig.origin[0], rig.origin[1], rig.origin[2], 0};
  batch.joint_features = rig.joint_features;
  batch.fades.assign(basis.residual.regions.size(), 1);
  backend->set_rest_coefficients(backend->run(batch).coefficients);
  for (const float c : backend->run(batch).coefficients) EXPECT_EQ(c, 0);
}

void expect_rigid(const DeviceChoice& device) {
  Deformer deformer(full_basis(), device);
  const Sample& sample = samples().heldout[7];
  const Evaluation still = deformer.evaluate({&sample.pose, 1});
  for (const double away : {0.0, 1.0, 100.0}) {
    Pose moved = sample.pose;
    const Quat turn = axis_angle({0.6, 0.8, 0}, 1.1);
    const Vec3 shift = {away, -0.7 * away, 0.3 * away};
    moved.joints[0].rotation = turn * moved.joints[0].rotation;
    moved.joints[0].translation = rotate(turn, moved.joints[0].translation) + shift;
    const Evaluation rigid = deformer.evaluate({&moved, 1});
    EXPECT_EQ(rigid.outside, still.outside);
    double worst = 0;
    for (std::size_t k = 0; k < still.positions.size(); k += 3) {
      const Vec3 expected = rotate(turn, {still.positions[k], still.positions[k + 1], still.positions[k + 2]}) + shift;
      for (std::size_t i = 0; i < 3; ++i) {
        worst = std::max(worst, std::abs(double{rigid.positions[k + i]} - expected[i]));
      }
    }
    // Units in the last place of the position, or of the limb where that is larger.
    const float magnitude = static_cast<float>(std::max(away, kLimbLength));
    const double ulp = double{std::nextafter(magnitude, 1e9f) - magnitude};
    ::testing::Test::RecordProperty(
        deformer.device_name() + " ulps_at_" + std::to_string(static_cast<int>(away)) + "_m",
        std::to_string(worst / ulp));
    EXPECT_LE(worst, 3 * ulp) << away << " m away";
  }
}

TEST(Train, RigidMotionInIsRigidMotionOut) { expect_rigid({.name = "cpu"}); }
TEST(Train, RigidMotionInIsRigidMotionOutOnADevice) { expect_rigid(testing::test_device()); }

TEST(Train, FlagsWhatTrainingNeverSaw) {
  Deformer deformer(full_basis(), {.name = "cpu"});
  Pose strange = samples().train[5].pose;
  EXPECT_EQ(deformer.evaluate({&strange, 1}).outside[0], 0);
  strange.joints[2].rotation = axis_angle({1, 0, 0}, 0.1);  // the wrist only ever bent around y
  const Evaluation evaluation = deformer.evaluate({&strange, 1});
  EXPECT_GT(evaluation.outside[0], 1);
  EXPECT_EQ(feature_name(full_basis(), evaluation.outside_feature[0]), "joint " + full_basis().skeleton.joints[2].name);
  EXPECT_NEAR(evaluation.outside_by[0], 0.1 * 180 / std::numbers::pi, 0.1);
  EXPECT_EQ(outside_text(full_basis(), evaluation.outside_feature[0], 5.73f), "5.7 degrees");
}

TEST(Train, SameResultWithAnyNumberOfThreads) {
  SampleSet set = samples();
  set.train.resize(40);
  const auto trained = [&] { return trained_basis(set, {.centres = 20}); };
  const Basis one = testing::on_threads(1, trained), two = testing::on_threads(2, trained);
  EXPECT_EQ(one.ddm.moments, two.ddm.moments);
  EXPECT_EQ(one.residual.weights, two.residual.weights);
  EXPECT_EQ(one.residual.centres, two.residual.centres);
  EXPECT_EQ(one.residual.blend_begin, two.residual.blend_begin);
  EXPECT_EQ(one.metadata, two.metadata);  // with the curve and all errors
  EXPECT_TRUE(testing::same_bits(one.residual.blend, two.residual.blend));
}

TEST(Train, RefusesTooLittleData) {
  SampleSet set = samples();
  set.train.resize(3);
  try {
    trained_basis(set, {});
    FAIL() << "trained on three frames";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mismatch);
  }
}

// In a process of its own, because the flag stays set, and started anew, because threads do not survive a fork.
TEST(Train, AnInterruptEndsItWithExitCode75AndClaimsNothing) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto interrupted_training = [] {
    catch_interrupts();
    std::raise(SIGINT);
    try {
      trained_basis(limb_samples(40, 0), {});
    } catch (const Error& error) {
      std::fputs(error.what(), stderr);
      std::exit(error.exit_code());
    }
    std::exit(1);
  };
  EXPECT_EXIT(interrupted_training(), ::testing::ExitedWithCode(75), "nothing of it is kept");
}

// What one kind of skinning posed, its own un-posing takes back to rest; the other one's leaves something.
TEST(Train, UnposingGivesBackWhatWasPosed) {
  SampleSet set = samples();
  const Basis basis =
      build_ddm_basis(set.character, {.smoothing_radius = default_smoothing_radius(set.character.vertices)});
  const std::vector<Positions> ddm = [&] {
    set.heldout = set.train;
    Deformer deformer(basis, {.name = "cpu"});
    return heldout_by_basis(set, deformer);
  }();
  for (std::size_t k = 0; k < set.train.size(); ++k) set.train[k].shape = ddm[k];
  const UnposingResidual of_ddm = unposing_residual(set, basis);
  EXPECT_LT(of_ddm.ddm, 1e-3);
  EXPECT_GT(of_ddm.lbs, 0.1);
  for (Sample& sample : set.train) sample.shape = skin_linear(set.character, sample.pose);
  const UnposingResidual of_lbs = unposing_residual(set, basis);
  EXPECT_LT(of_lbs.lbs, 1e-9);
  EXPECT_GT(of_lbs.ddm, 0.1);
}

// With memory for one region at a time the shapes are read again for each, to the same basis.
TEST(Train, LittleMemoryChangesNothing) {
  const Basis little = trained_basis(samples(), {.centres = 100, .memory_gib = 1e-4});
  EXPECT_EQ(testing::difference(little, full_basis()), "");
}

}  // namespace train_test
}  // namespace bodyopt::trainer
