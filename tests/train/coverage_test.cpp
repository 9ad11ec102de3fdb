// Expected errors against errors measured on a synthetic limb, and what coverage makes of bad input.
#include "trainer/train/coverage/coverage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "runtime/core/error.h"
#include "runtime/core/json.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/trained_basis.h"
#include "trainer/train/fit/train.h"
#include "trainer/train/judge/test_errors.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::trainer {
namespace {

const SampleSet& samples() {
  static const SampleSet set = limb_samples(160, 60);
  return set;
}

const Basis& basis() {
  static const Basis trained = trained_basis(
      samples(), {.smoothing_radius = default_smoothing_radius(samples().character.vertices), .centres = 60});
  return trained;
}

std::vector<Pose> heldout_poses() {
  std::vector<Pose> poses;
  for (const Sample& sample : samples().heldout) poses.push_back(sample.pose);
  return poses;
}

TEST(Coverage, ExpectsAboutTheErrorThatIsMeasured) {
  Deformer deformer(basis(), {.name = "cpu"});
  const double measured = heldout_errors(samples().heldout, heldout_by_basis(samples(), deformer)).rms;
  double sum = 0;
  for (const ExpectedError& error : expected_errors(basis(), heldout_poses())) {
    sum += error.rms_mm * error.rms_mm;
  }
  const double expected = std::sqrt(sum / static_cast<double>(samples().heldout.size()));
  RecordProperty("expected_and_measured_mm", std::to_string(expected) + " " + std::to_string(measured));
  EXPECT_LT(expected, 2 * measured);
  EXPECT_GT(expected, 0.5 * measured);
}

TEST(Coverage, ExpectsMoreTheFurtherAPoseLeavesTheTrainedRange) {
  std::vector<Pose> poses;
  for (const double bend : {1.0, 2.2, 2.6, 3.0}) {
    Pose& pose = poses.emplace_back(bind_pose(basis().skeleton));
    pose.joints.back().rotation = pose.joints.back().rotation * axis_angle({0.6, 0, 0.8}, bend);
  }
  const auto errors = expected_errors(basis(), poses);
  for (std::size_t k = 1; k < errors.size(); ++k) EXPECT_GT(errors[k].rms_mm, errors[k - 1].rms_mm) << k;
}

TEST(Coverage, SeesJointsThatTrainingNeverMoved) {
  SampleSet still = samples();
  for (Sample& sample : still.train) {
    sample.pose.joints[2].rotation = bind_pose(still.character.skeleton).joints[2].rotation;
    sample.shape = limb_truth(still.character, still.muscles, sample.pose);
  }
  const Basis stiff = trained_basis(still, {.centres = 60});
  Pose turned = still.train[20].pose;
  turned.joints[2].rotation = turned.joints[2].rotation * axis_angle({0, 1, 0}, 0.5);
  const auto errors = expected_errors(stiff, {still.train[20].pose, turned});
  EXPECT_GT(errors[1].rms_mm, 3 * errors[0].rms_mm);
}

TEST(Coverage, IsCalibratedFromTheFramesAroundEachCentre) {
  // One feature; the energy left is 1 below 0 and 9 above.
  RegressionData data;
  constexpr int kFrames = 40;
  data.features = Eigen::VectorXd::LinSpaced(kFrames, -1, 1);
  data.rest = Eigen::RowVectorXd::Constant(1, -2);
  Regression regression;
  regression.centres = (Eigen::MatrixXd(2, 1) << -0.5, 0.5).finished();
  regression.centre_frames = {9, 30};
  for (int n = 0; n < kFrames; ++n) data.folds.push_back(n % 2);
  std::vector<double> energies(kFrames / 2, 1);
  energies.resize(kFrames, 9);
  const ErrorModel model = calibrate({data, regression, energies}, std::vector<double>(kFrames, 10));
  ASSERT_EQ(model.local.size(), 2u);
  EXPECT_NEAR(model.local[0], (20 * 1 + 5) / 21.0, 1e-12);  // the mean of all counts as one frame more
  EXPECT_NEAR(model.local[1], (20 * 9 + 5) / 21.0, 1e-12);
  EXPECT_EQ(model.motion, std::vector<double>(2, 10));
  EXPECT_GT(model.usual, 0);
  EXPECT_GT(model.growth, 0);
}

// Three takes along one coordinate, a centre in each: a frame is seen from the nearest centre of another take.
TEST(Coverage, SeesTakesThatWereLeftOutFromTheOthers) {
  constexpr int kFrames = 60;
  RegressionData by_takes;
  by_takes.features = Eigen::VectorXd::LinSpaced(kFrames, 1, 7);
  by_takes.rest = Eigen::RowVectorXd::Zero(1);
  for (int n = 0; n < kFrames; ++n) by_takes.folds.push_back(n / 20);
  Regression regression;
  regression.centres = (Eigen::MatrixXd(3, 1) << 2, 4, 6).finished();
  regression.centre_frames = {10, 30, 49};
  const ErrorModel model{.local = {1, 2, 3}, .motion = {10, 20, 30}, .usual = 0.5};
  const std::vector<double> left(kFrames, 7);
  const std::vector<LeftOutFrame> frames = left_out_frames({by_takes, regression, left}, model);
  ASSERT_EQ(frames.size(), std::size_t{kFrames});
  for (int n = 0; n < kFrames; ++n) {
    const double x = by_takes.features(n);
    const int take = n / 20;
    const std::size_t nearest = take != 1 ? 1 : x < 4 ? 0 : 2;
    const double squared = std::pow(x - regression.centres(static_cast<Eigen::Index>(nearest)), 2);
    const LeftOutFrame& frame = frames[static_cast<std::size_t>(n)];
    EXPECT_EQ(frame.take, take);
    EXPECT_EQ(frame.left, 7);
    EXPECT_EQ(frame.local, take == 0 && x * x < squared ? model.local[0] : model.local[nearest]) << n;
    EXPECT_NEAR(frame.further, std::max(0.0, std::min(squared, x * x) - 0.5), 1e-9) << n;
  }
}

// Two regions of unlike motion, and two short takes: what was left of these grows with the distance by a fifth of the
// motion. Nothing of the third was foretold, but without it most frames are missing.
TEST(Coverage, GrowsByWhatIsLeftOfTakesThatWereLeftOut) {
  std::vector<ErrorModel> models = {{.local = {1}, .motion = {100}, .growth = 9, .usual = 2},
                                    {.local = {3}, .motion = {900}, .growth = 9, .usual = 0.5}};
  std::vector<std::vector<LeftOutFrame>> regions(2);
  for (std::size_t r = 0; r < 2; ++r) {
    const double motion = models[r].motion[0], growth = 0.2 * motion / models[r].usual;
    for (const double further : {0.0, 0.5, 1.0, 90.0}) {
      const double left = std::min(models[r].local[0] + growth * further, motion);
      for (const int take : {1, 2}) regions[r].push_back({take, left, models[r].local[0], motion, further});
    }
    for (int n = 0; n < 20; ++n) regions[r].push_back({0, 1e6, models[r].local[0], motion, 1});
  }
  grow_by_takes(regions, models);
  EXPECT_DOUBLE_EQ(models[0].growth, 0.2 * 100 / 2);
  EXPECT_DOUBLE_EQ(models[1].growth, 0.2 * 900 / 0.5);
  for (std::vector<LeftOutFrame>& frames : regions) {
    for (LeftOutFrame& frame : frames) frame.take = 0;
  }
  models[0].growth = 9;
  grow_by_takes(regions, models);
  EXPECT_EQ(models[0].growth, 9);  // one take tells nothing of others
}

// However far a pose is, Direct Delta Mush is all that it can fall back to.
TEST(Coverage, ExpectsNoMoreThanWhatTheSkinMoves) {
  Basis changed = basis();
  CoverageTable& coverage = changed.coverage;
  ASSERT_EQ(coverage.motion.size(), coverage.local.size());
  Pose far = bind_pose(basis().skeleton);
  far.joints.back().rotation = far.joints.back().rotation * axis_angle({0, 1, 0}, 3);
  const std::vector<double> before = expected_errors(changed, {far})[0].region_mm;
  double largest = 0;
  auto motion = coverage.motion.begin();
  for (std::size_t r = 0; r < before.size(); ++r) {
    const auto next = motion + std::max(1u, changed.residual.regions[r].centre_count);
    const double most = 1e3 * double{*std::max_element(motion, next)};
    motion = next;
    EXPECT_LE(before[r], most * (1 + 1e-9)) << coverage.names[r];
    largest = std::max(largest, before[r] / most);
    coverage.growth[r] *= 1e6f;
  }
  EXPECT_GT(largest, 0.5);
  const std::vector<double> further = expected_errors(changed, {far})[0].region_mm;
  for (std::size_t r = 0; r < further.size(); ++r) EXPECT_LT(further[r], 1e3) << coverage.names[r];
  coverage.motion.clear();  // as files of older versions are: not capped
  const double capped = *std::max_element(further.begin(), further.end());
  EXPECT_GT(expected_errors(changed, {far})[0].rms_mm, 10 * capped);
}

TEST(Coverage, RanksAreCorrelatedAsSpearmanHasIt) {
  EXPECT_NEAR(rank_correlation({1, 2, 3, 4}, {10, 20, 30, 1000}), 1, 1e-12);
  EXPECT_NEAR(rank_correlation({1, 2, 3, 4}, {4, 3, 2, 1}), -1, 1e-12);
  EXPECT_NEAR(rank_correlation({106, 100, 86, 101, 99, 103, 97, 113, 112, 110}, {7, 27, 2, 50, 28, 29, 20, 12, 6, 17}),
              -29.0 / 165, 1e-12);  // a textbook's example: intelligence and hours of television
  EXPECT_NEAR(rank_correlation({1, 1, 2}, {1, 2, 3}), std::sqrt(0.75), 1e-12);  // ties share their rank
  EXPECT_TRUE(std::isnan(rank_correlation({1, 1}, {1, 2})));
}

TEST(Coverage, NamesTheWorstFramesThatAreNotNeighbours) {
  const std::vector<double> expected = {1, 5, 4.9, 4, 0, 3, 3};
  EXPECT_EQ(worth_simulating(expected, 3, 2), (std::vector<std::size_t>{1, 3, 5}));
  EXPECT_EQ(worth_simulating(expected, 2, 1), (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(worth_simulating(expected, 100, 3).size(), 2u);
  EXPECT_TRUE(worth_simulating({}, 3, 2).empty());
}

// By the names that the training's report has.
TEST(Coverage, RegionsHaveTheirNames) {
  std::vector<std::string> reported;
  const auto report = Json::parse(basis().metadata.at("report"));
  for (const auto& region : report.at("regions")) reported.push_back(region.at("name"));
  auto at = reported.begin();  // those that are kept, in the same order
  for (const std::string& name : basis().coverage.names) {
    at = std::find(at, reported.end(), name);
    ASSERT_NE(at, reported.end()) << name;
  }
}

// A region's true error is that of its vertices, by weight; over the whole skin it is the RMS of all.
TEST(Coverage, TrueErrorsOfRegionsAreThoseOfTheirVertices) {
  std::vector<Positions> shapes;
  for (const Sample& sample : samples().heldout) {
    shapes.push_back(sample.shape.read());
    shapes.back().row(3) += Eigen::RowVector3d(0.003, 0, 0.004);
  }
  shapes.front().row(7)[1] += 0.001 * static_cast<double>(shapes.size());
  const VertexErrors errors = vertex_errors(samples(), shapes);
  EXPECT_NEAR(errors.mean[3], 5, 1e-9);
  EXPECT_NEAR(errors.mean[7], 1, 1e-9);
  EXPECT_EQ(errors.mean[5], 0);
  EXPECT_NEAR(region_rms(errors, {"", {3, 5}, {0.25, 0.75}}), 2.5, 1e-9);
  RegionWeights skin;
  for (Eigen::Index v = 0; v < samples().character.vertices.rows(); ++v) {
    skin.vertices.push_back(static_cast<std::uint32_t>(v));
    skin.weights.push_back(1);
  }
  EXPECT_NEAR(region_rms(errors, skin), heldout_errors(samples().heldout, shapes).rms, 1e-5);
}

TEST(Coverage, ABasisThatDoesNotKnowItsErrorIsRefused) {
  Basis plain = basis();
  plain.coverage = {};
  try {
    expected_errors(plain, heldout_poses());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mismatch);
  }
}

}  // namespace
}  // namespace bodyopt::trainer
