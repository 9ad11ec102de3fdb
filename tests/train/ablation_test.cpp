// The table of methods on a synthetic limb.
#include <gtest/gtest.h>

#include <map>

#include "tests/support/capsule_limb.h"
#include "trainer/train/fit/train.h"
#include "trainer/train/judge/test_errors.h"

namespace bodyopt::trainer {
namespace {

const std::map<std::string, MethodResult>& rows() {
  static const std::map<std::string, MethodResult> made = [] {
    const SampleSet set = limb_samples(160, 60);
    const TrainOptions options{.centres = 60};
    std::map<std::string, MethodResult> by_name;
    std::vector<std::string> unmade;
    for (const MethodResult& row : ablate(set, options, train(set, options), 1.5, unmade)) by_name[row.name] = row;
    EXPECT_TRUE(unmade.empty());
    return by_name;
  }();
  return made;
}

double rms(const std::string& name) { return rows().at(name).errors.rms; }

TEST(Ablation, EveryMethodLearnsFromItsOwnUnposing) {
  // A displacement un-posed by one and posed by the other would be off by more than what either leaves.
  for (const auto& [name, row] : rows()) {
    RecordProperty(name, std::to_string(row.errors.rms));
    if (name == "LBS" || name == "DDM") continue;
    EXPECT_LT(row.errors.rms, 0.7 * rms(name.starts_with("LBS") ? "LBS" : "DDM")) << name;
  }
}

TEST(Ablation, EachPartIsWorthSomething) {
  const double full = rms("full: DDM + strains, kernels, dynamic");
  for (const char* name : {"DDM + joints, linear, dense", "DDM + joints, linear, local",
                           "LBS + joints, linear, dense"}) {  // kernels of joints tell all there is of this limb
    EXPECT_LT(full, 0.5 * rms(name)) << name;
  }
  EXPECT_LT(full, 0.1 * rms("DDM"));
  for (const auto& [name, row] : rows()) EXPECT_LT(full, 1.02 * row.errors.rms + 0.01) << name;
  // Two bends are few enough to be learned for the whole skin at once; more joints are not.
  EXPECT_LT(rms("DDM + strains, kernels, static"), 1.5 * rms("DDM + strains, kernels, dense"));
}

TEST(Ablation, SaysWhatEachCosts) {
  const MethodResult& full = rows().at("full: DDM + strains, kernels, dynamic");
  EXPECT_EQ(full.seconds, 1.5);
  EXPECT_EQ(rows().at("DDM").coefficients, 0u);
  EXPECT_LT(rows().at("DDM").bytes_per_vertex, full.bytes_per_vertex);
  for (const auto& [name, row] : rows()) {
    if (name == "LBS" || name == "DDM") continue;
    EXPECT_GT(row.coefficients, 0u) << name;
    EXPECT_GT(row.bytes_per_vertex, rows().at("LBS").bytes_per_vertex) << name;
    RecordProperty("bytes of " + name, std::to_string(row.bytes_per_vertex));
    EXPECT_LE(row.bytes_per_vertex, full.bytes_per_vertex) << name;
  }
  // What the peers leave out does harm; they are not short of room. Of few frames the full model has all that helps.
  for (const char* name : {"DDM + joints, linear, local", "DDM + joints, kernels, static"}) {
    EXPECT_GT(rows().at(name).bytes_per_vertex, 0.8 * full.bytes_per_vertex) << name;
  }
}

}  // namespace
}  // namespace bodyopt::trainer
