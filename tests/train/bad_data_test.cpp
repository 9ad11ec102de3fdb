// Training on data with something wrong in it: what it says, and what it learns all the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>

#include "assets/caches/pc2.h"
#include "assets/caches/shape_reader.h"
#include "runtime/core/error.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/damaged_cache.h"
#include "tests/support/same_basis.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/trained_basis.h"
#include "trainer/train/data/data_warnings.h"
#include "trainer/train/data/unposed_shapes.h"
#include "trainer/train/fit/train.h"
#include "trainer/train/judge/test_errors.h"
#include "trainer/train/options.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::trainer {
namespace {

const TrainOptions kSmall{.components = 8, .centres = 30};

const SampleSet& clean() {
  static const SampleSet set = limb_samples(80, 30);
  return set;
}

const TrainingResult& clean_result() {
  static const TrainingResult result = train(clean(), kSmall);
  return result;
}

double heldout_rms(const SampleSet& set, const Basis& basis) {
  Deformer deformer(basis, {.name = "cpu"});
  return heldout_errors(set.heldout, heldout_by_basis(set, deformer)).rms;
}

// What the shapes do is known exactly: displacements of every frame, in runtime order.
Displacements wave(const Character& character, int frames) {
  Displacements displacements(frames, character.vertices.size());
  for (Eigen::Index n = 0; n < frames; ++n) {
    for (Eigen::Index v = 0; v < character.vertices.rows(); ++v) {
      const double z = character.vertices(v, 2), t = 0.3 * static_cast<double>(n);
      displacements.row(n).segment<3>(3 * v) =
          Eigen::RowVector3d(0.02 * std::sin(9 * z + t), 0.01 * std::cos(7 * z - t), 0.01 * std::sin(t)).cast<float>();
    }
  }
  return displacements;
}

template <typename Number>
std::vector<Number> up_to(std::size_t count) {
  std::vector<Number> numbers(count);
  for (std::size_t k = 0; k < count; ++k) numbers[k] = static_cast<Number>(k);
  return numbers;
}

TEST(OutlierVertices, AreFoundAndPutBackAmongTheirNeighbours) {
  const Character character = limb_character();
  const Displacements truth = wave(character, 40);
  const auto frames = up_to<std::size_t>(40);
  const auto vertices = up_to<std::uint32_t>(static_cast<std::size_t>(character.vertices.rows()));
  const OutlierVertices neighbours(character);
  Displacements displacements = truth;
  EXPECT_TRUE(neighbours.mend(displacements, frames, vertices).empty());
  EXPECT_EQ(displacements, truth);
  // Two that are neighbours, one alone, in two frames.
  displacements(7, 3 * 100 + 1) += 0.5f;
  displacements(7, 3 * 101 + 2) -= 0.3f;
  displacements(21, 3 * 400) += 0.1f;
  const std::vector<OutlierVertex> outliers = neighbours.mend(displacements, frames, vertices);
  ASSERT_EQ(outliers.size(), 3u);
  const std::tuple<std::size_t, std::uint32_t, double> expected[] = {{7, 100, 0.5}, {7, 101, 0.3}, {21, 400, 0.1}};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(outliers[k].frame, std::get<0>(expected[k]));
    EXPECT_EQ(outliers[k].vertex, std::get<1>(expected[k]));
    EXPECT_NEAR(outliers[k].distance, std::get<2>(expected[k]), 0.005);
  }
  EXPECT_LT((displacements - truth).cwiseAbs().maxCoeff(), 0.004);
}

// A vertex that is always far from its neighbours, and a patch that moves as one, are how the skin is.
TEST(OutlierVertices, AreNotWhatTheSkinDoes) {
  const Character character = limb_character();
  Displacements displacements = wave(character, 40);
  for (int n = 0; n < 40; ++n) displacements(n, 3 * 250) += 0.05f + 0.001f * static_cast<float>(n);
  displacements.row(9).segment(3 * 200, 3 * 5 * kLimbSides).array() += 0.1f;  // of five rings
  const Displacements before = displacements;
  const auto vertices = up_to<std::uint32_t>(static_cast<std::size_t>(character.vertices.rows()));
  EXPECT_TRUE(OutlierVertices(character).mend(displacements, up_to<std::size_t>(40), vertices).empty());
  EXPECT_EQ(displacements, before);
}

TEST(BadData, CleanDataGivesNoWarnings) { EXPECT_EQ(clean_result().warnings, std::vector<std::string>{}); }

TEST(BadData, AVertexThatFliesAwayIsNamedAndHardlyMatters) {
  SampleSet set = clean();
  Positions shape = set.train[33].shape.read();
  shape.row(345) += Eigen::RowVector3d(0.3, -0.4, 0);
  set.train[33].shape = shape;
  const TrainingResult result = train(set, kSmall);
  const Basis& basis = result.basis;
  const std::vector<std::string>& warnings = result.warnings;
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].find("frame 34 of take 'training': vertex 345 is "), 0u) << warnings[0];
  EXPECT_NEAR(std::stod(warnings[0].substr(warnings[0].find(" is ") + 4)), 500, 10);
  const double error = heldout_rms(set, basis), before = heldout_rms(clean(), clean_result().basis);
  RecordProperty("rms_mm", std::to_string(before) + " clean, " + std::to_string(error) + " mended");
  EXPECT_NEAR(error, before, 0.03 * before);
  // The same, however much of the skin is in memory.
  TrainOptions little = kSmall;
  little.memory_gib = 1e-6;
  EXPECT_EQ(testing::difference(basis, trained_basis(set, little)), "");
}

TEST(BadData, ManyOutlierVerticesAreCounted) {
  SampleSet set = clean();
  for (std::size_t n = 10; n < 18; ++n) {
    Positions shape = set.train[n].shape.read();
    shape(static_cast<Eigen::Index>(30 * n), 2) += 0.2;
    set.train[n].shape = shape;
  }
  const std::vector<std::string> warnings = train(set, kSmall).warnings;
  ASSERT_EQ(warnings.size(), 6u);
  EXPECT_EQ(warnings[5], "3 more vertices of single frames flew away from their neighbours");
}

// The first frames once more, as another take, bulging where the flexor lies.
SampleSet with_second_take(double bulge) {
  SampleSet set = clean();
  set.takes.push_back("again");
  for (std::size_t n = 0; n < 7; ++n) {
    Sample sample = set.train[n];
    sample.take = 2;
    Positions shape = sample.shape.read();
    for (Eigen::Index v = 0; v < shape.rows(); ++v) {
      const Eigen::RowVector3d rest = set.character.vertices.row(v);
      const double along = (rest.z() - 0.12) / 0.06;
      shape(v, 1) += bulge * std::max(0.0, rest.y() / kLimbRadius) * std::exp(-along * along);
    }
    sample.shape = shape;
    set.train.push_back(std::move(sample));
  }
  return set;
}

TEST(BadData, ContradictoryShapesOfOnePoseAreNamed) {
  const std::vector<std::string> warnings = train(with_second_take(0.02), kSmall).warnings;
  ASSERT_EQ(warnings.size(), 6u);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_NE(warnings[k].find(" of take 'training' and frame "), std::string::npos) << warnings[k];
    EXPECT_NE(warnings[k].find(" of take 'again' have the same pose and controls"), std::string::npos) << warnings[k];
    const double distance = std::stod(warnings[k].substr(warnings[k].find("shapes are ") + 11));
    EXPECT_GT(distance, 3);
    EXPECT_LT(distance, 20);
  }
  EXPECT_EQ(warnings[5].find("2 more pairs of frames"), 0u) << warnings[5];
}

TEST(BadData, AgreeingShapesOfOnePoseAreFine) {
  EXPECT_EQ(train(with_second_take(1e-5), kSmall).warnings, std::vector<std::string>{});
}

// The same pose with another value of a control is another matter.
TEST(BadData, ControlsTellPosesApart) {
  SampleSet set = with_second_take(0.02);
  set.controls = {"bulge"};
  for (Sample& sample : set.train) sample.pose.controls = {sample.take == 2 ? 1.0f : 0.0f};
  for (Sample& sample : set.heldout) sample.pose.controls = {0.0f};
  EXPECT_EQ(train(set, kSmall).warnings, std::vector<std::string>{});
}

TEST(Contradictions, FramesOfOnePoseAreThoseThatComparingAllFinds) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd features = Eigen::MatrixXd::NullaryExpr(300, 60, [&] { return normal(random); });
  for (Eigen::Index n = 200; n < 260; ++n) features.row(n) = features.row(3 * (n - 200)).array() + 5e-4;
  for (Eigen::Index n = 260; n < 280; ++n) {
    features.row(n) = features.row(5);
    features(n, n % 60) += 0.01;
  }
  features.row(299) = features.row(250);
  std::vector<std::pair<std::size_t, std::size_t>> expected, found;
  for (Eigen::Index b = 0; b < 300; ++b) {
    for (Eigen::Index a = 0; a < b; ++a) {
      if ((features.row(a) - features.row(b)).cwiseAbs().maxCoeff() > 1e-3) continue;
      expected.emplace_back(a, b);
      break;
    }
  }
  for (const FramePair& pair : frames_of_one_pose(features)) found.emplace_back(pair.first, pair.second);
  ASSERT_EQ(expected.size(), 61u);
  EXPECT_EQ(found, expected);
}

TEST(BadData, ConstantControlsAndFewFramesAreSaid) {
  SampleSet set = limb_samples(14, 0);
  set.controls = {"still", "fade"};
  for (Sample& sample : set.train) {
    sample.pose.controls = {0.5f, static_cast<float>(std::sin(sample.frame))};
  }
  const TrainingResult result = train(set, kSmall);
  const Basis& basis = result.basis;
  const std::vector<std::string>& warnings = result.warnings;
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_EQ(warnings[0], "control 'still' is 0.5 in every training frame: what it does cannot be learned");
  EXPECT_EQ(warnings[1].find("14 training frames for "), 0u) << warnings[1];
  EXPECT_LT(heldout_rms(set, basis), 2);
  // A constant control teaches nothing, wherever it is set.
  Deformer deformer(basis, {.name = "cpu"});
  Pose pose = set.train[6].pose;
  const std::vector<float> there = deformer.evaluate({&pose, 1}).positions;
  pose.controls[0] = 0.2f;
  EXPECT_EQ(deformer.evaluate({&pose, 1}).positions, there);
}

std::string message_of(const SampleSet& set) {
  try {
    trained_basis(set, kSmall);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mismatch);
    return error.what();
  }
  return "";
}

TEST(BadData, NumbersThatAreNotFiniteAreNamed) {
  SampleSet set = clean();
  set.train[3].pose.joints[2].rotation[1] = std::nan("");
  EXPECT_EQ(message_of(set),
            "frame 4 of take 'training': the transform of joint 'joint2' holds a number that is not finite");
  set = clean();
  set.heldout[2].pose.joints[0].translation[1] = INFINITY;
  EXPECT_EQ(message_of(set),
            "frame 83 of take 'heldout': the transform of joint 'joint0' holds a number that is not finite");
  set = clean();
  set.controls = {"flex"};
  for (auto* samples : {&set.train, &set.heldout}) {
    for (Sample& sample : *samples) sample.pose.controls = {0.1f};
  }
  set.train[8].pose.controls[0] = std::nanf("");
  EXPECT_EQ(message_of(set), "frame 9 of take 'training': the value of control 'flex' is not a finite number");
  set = clean();
  Positions shape = set.train[40].shape.read();
  shape(5, 1) = std::nan("");
  set.train[40].shape = shape;
  EXPECT_EQ(message_of(set), "frame 41 of take 'training': its shape holds a number that is not finite");
}

TEST(BadData, AFileThatHoldsNoNumbersIsNamedWithItsFrame) {
  const TemporaryFolder folder;
  SampleSet set = clean();
  const std::string path = folder / "shapes.pc2";
  Pc2Writer writer(path, set.character.output_count(), 80);
  for (std::size_t n = 0; n < 80; ++n) {
    writer.append(output_from_welded(set.character, set.train[n].shape.read()));
  }
  writer.close();
  put_nan(path, 55, 3 * 17 + 1);
  const auto cache = std::make_shared<const ShapeCache>(
      ShapeCache{std::make_shared<const ShapeReader>(path), std::make_shared<const Character>(set.character)});
  for (std::uint32_t n = 0; n < 80; ++n) set.train[n].shape = {cache, n};
  try {
    trained_basis(set, kSmall);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::file);
    const std::string expected =
        "frame 56 of take 'training': " + path + ": sample 55, point 17 is not a finite number";
    EXPECT_EQ(std::string(error.what()).find(expected), 0u) << error.what();
  }
}

}  // namespace
}  // namespace bodyopt::trainer
