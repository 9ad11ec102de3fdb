// The two limits on a basis' size, and the curve of what they can ask for, on the synthetic limb.
#include "trainer/train/pack/trade_off.h"

#include <gtest/gtest.h>

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
namespace trade_off_test {

const SampleSet& samples() {
  static const SampleSet set = limb_samples(160, 60);
  return set;
}

Basis trained(double budget, double tolerance_mm) {
  return trained_basis(samples(), {.centres = 60, .budget = budget, .tolerance_mm = tolerance_mm});
}

const TrainingResult& usual_result() {
  static const TrainingResult result = train(samples(), {.centres = 60});
  return result;
}

const Basis& usual() { return usual_result().basis; }

double expected_mm(const Basis& basis) { return Json::parse(basis.metadata.at("report")).at("expected_rms_mm"); }

double heldout_rms(const Basis& basis) {
  Deformer deformer(basis, {.name = "cpu"});
  return heldout_errors(samples().heldout, heldout_by_basis(samples(), deformer)).rms;
}

std::string refusal(double budget) {
  try {
    trained(budget, 0);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    return error.what();
  }
  return "";
}

TEST(TradeOff, TheCurveRunsFromDirectDeltaMushToEverything) {
  const std::vector<TradeOffPoint> curve = read_curve(usual());
  ASSERT_GE(curve.size(), 12u);
  const Basis bare = without_residual(usual());
  EXPECT_EQ(curve.front().coefficients, 0u);
  EXPECT_NEAR(curve.front().bytes_per_vertex, bytes_per_vertex(bare), 1);
  // All frames that cross-validation held out: what Direct Delta Mush leaves of them.
  EXPECT_NEAR(curve.front().expected_mm, unposing_residual(samples(), usual()).ddm, 0.1 * curve.front().expected_mm);
  for (std::size_t k = 1; k < curve.size(); ++k) {
    EXPECT_GE(curve[k].bytes_per_vertex, curve[k - 1].bytes_per_vertex) << k;
    EXPECT_GE(curve[k].microseconds, curve[k - 1].microseconds) << k;
    EXPECT_LE(curve[k].expected_mm, 1.01 * curve[k - 1].expected_mm) << k;
  }
  EXPECT_LT(curve.back().expected_mm, 0.2 * curve.front().expected_mm);
  EXPECT_EQ(read_curve(bare).size(), curve.size());
  EXPECT_TRUE(read_curve(build_ddm_basis(samples().character, {})).empty());
}

// Shapes of Direct Delta Mush leave nothing to learn, where it is so smooth that no rounding repeats: a budget with
// room to spare has no one to serve, and is kept.
TEST(TradeOff, ABudgetIsKeptWhereNothingIsLearned) {
  SampleSet set = limb_samples(24, 8);
  constexpr double radius = 0.03;
  Deformer plain(build_ddm_basis(set.character, {.smoothing_radius = radius}), {.name = "cpu"});
  SampleSet asked = set;
  asked.heldout = set.train;
  const std::vector<Positions> shapes = heldout_by_basis(asked, plain);
  for (std::size_t n = 0; n < shapes.size(); ++n) set.train[n].shape = shapes[n];
  const Basis basis = train(set, {.smoothing_radius = radius, .budget = 1000}).basis;
  EXPECT_EQ(basis.residual.coefficient_count(), 0u);
  EXPECT_LE(bytes_per_vertex(basis), 1000);
}

TEST(TradeOff, TheBasisTellsWhatTheTrainingFound) {
  const TrainingResult& found = usual_result();
  const auto report = Json::parse(found.basis.metadata.at("report"));
  EXPECT_EQ(report.at("expected_rms_mm"), found.expected_mm);
  EXPECT_EQ(report.at("warnings"), found.warnings);
  ASSERT_EQ(report.at("regions").size(), found.fits.size());
  ASSERT_EQ(found.regions.size(), found.fits.size());
  double sum = 0;
  for (std::size_t r = 0; r < found.fits.size(); ++r) {
    EXPECT_EQ(report["regions"][r].at("name"), found.regions[r].name);
    EXPECT_EQ(report["regions"][r].at("motion_rms_mm"), found.fits[r].motion_rms_mm);
    for (const double weight : found.regions[r].weights) sum += weight;
  }
  EXPECT_NEAR(sum, static_cast<double>(samples().character.vertices.rows()), 1e-6);  // a partition of unity
  ASSERT_FALSE(found.muscles.empty());
  for (const MuscleShare& muscle : found.muscles) {
    EXPECT_EQ(report.at("muscles_explain_percent").at(muscle.name), muscle.percent);
  }
  const std::vector<TradeOffPoint> curve = read_curve(found.basis);
  ASSERT_EQ(curve.size(), found.curve.size());
  for (std::size_t k = 0; k < curve.size(); ++k) EXPECT_EQ(curve[k].expected_mm, found.curve[k].expected_mm);
  for (std::size_t r = 0; r < found.basis.coverage.names.size(); ++r) {
    const auto fit = std::ranges::find(found.fits, found.basis.coverage.names[r], &RegionFit::name);
    ASSERT_NE(fit, found.fits.end());
    const std::uint32_t most = found.basis.coverage.joints[found.basis.coverage.joint_begin[r]];
    EXPECT_EQ(found.basis.skeleton.joints[most].name, fit->joint);
  }
}

TEST(TradeOff, ABudgetIsKeptAndUsed) {
  const std::vector<TradeOffPoint> curve = read_curve(usual());
  const double least = curve.front().bytes_per_vertex, most = curve.back().bytes_per_vertex;
  double last = 1e9;
  for (const double share : {0.3, 0.8}) {
    const double budget = least + share * (most - least);
    const Basis basis = trained(budget, 0);
    EXPECT_LE(bytes_per_vertex(basis), budget);
    EXPECT_GT(bytes_per_vertex(basis), least + 0.8 * share * (most - least));
    const double rms = heldout_rms(basis);
    EXPECT_LT(rms, last);
    last = rms;
  }
}

TEST(TradeOff, BudgetsTooSmallToLearnAnythingAreRefused) {
  const double ddm = bytes_per_vertex(without_residual(usual()));
  const std::string below = refusal(0.5 * ddm), barely = refusal(ddm + 1);
  EXPECT_NE(below.find("Direct Delta Mush alone takes"), std::string::npos) << below;
  EXPECT_NE(below.find("--smoothing-radius"), std::string::npos) << below;
  EXPECT_NE(barely.find("the least that holds anything learned takes"), std::string::npos) << barely;
}

TEST(TradeOff, AToleranceIsMetWithFewBytes) {
  const double tolerance = 3 * expected_mm(usual());
  const Basis basis = trained(0, tolerance);
  EXPECT_LE(expected_mm(basis), tolerance);
  EXPECT_GT(expected_mm(basis), 0.7 * tolerance);
  EXPECT_LT(bytes_per_vertex(basis), bytes_per_vertex(usual()));
}

TEST(TradeOff, AToleranceOutOfReachGivesTheBestThereIs) {
  const Basis basis = trained(0, 1e-6);
  EXPECT_DOUBLE_EQ(bytes_per_vertex(basis), read_curve(usual()).back().bytes_per_vertex);
  EXPECT_GT(expected_mm(basis), 1e-6);
}

TEST(TradeOff, ACurveThatIsDamagedIsRefused) {
  Basis basis = without_residual(usual());
  for (const char* text : {"", "[", "[{}]", "[1]", R"([{"bytes_per_vertex": "many"}])"}) {
    basis.metadata["curve"] = text;
    EXPECT_THROW(read_curve(basis), Error) << text;
  }
}

}  // namespace trade_off_test
}  // namespace bodyopt::trainer
