// Real models against the tendon lengths that MuJoCo computes (tests/other_programs/mujoco.sh).
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "runtime/core/json.h"
#include "tests/support/paths.h"
#include "tests/support/shared_data.h"
#include "trainer/muscle_models/model.h"

namespace bodyopt::trainer::muscle_models {
namespace {

using Row = std::vector<double>;

struct Lengths {
  std::vector<std::string> joints, tendons;
  std::vector<Row> poses, lengths;  // [pose][joint], [pose][tendon]

  Row of(const std::string& muscle) const {
    const auto tendon = std::find(tendons.begin(), tendons.end(), muscle + "_tendon");
    EXPECT_NE(tendon, tendons.end()) << "no reference for " << muscle;
    Row result;
    for (const Row& row : lengths) result.push_back(row.at(static_cast<std::size_t>(tendon - tendons.begin())));
    return result;
  }
};

Lengths read_lengths(const std::string& model) {
  std::ifstream file(kSourceFolder + "/tests/data/mujoco_lengths/" + model + ".json");
  const Json json = Json::parse(file);
  return {json.at("joints"), json.at("tendons"), json.at("poses"), json.at("lengths")};
}

// Per pose; joints that the model does not have are left out.
Row traced(const Model& model, const ModelMuscle& muscle, const Lengths& reference) {
  Row result;
  for (const Row& pose : reference.poses) {
    Row values = default_values(model);
    for (std::size_t k = 0; k < pose.size(); ++k) {
      const int coordinate = model.find_coordinate(reference.joints[k]);
      if (coordinate >= 0) values[static_cast<std::size_t>(coordinate)] = pose[k];
    }
    result.push_back(path_length(trace_path(muscle, pose_model(model, values))));
  }
  return result;
}

double largest_difference(const Row& a, const Row& b) {
  double largest = 0;
  for (std::size_t k = 0; k < b.size(); ++k) largest = std::max(largest, std::abs(a.at(k) - b[k]));
  return largest;
}

void expect_lengths(const std::string& folder, const std::string& name, std::size_t muscles, int unwrapped) {
  const auto path = shared_data("muscles/myo_sim/" + folder + "/" + name + ".xml");
  if (!path) GTEST_SKIP() << kNeedsOtherWriters;
  const Model model = read_model(*path);
  const Lengths reference = read_lengths(name);
  ASSERT_EQ(model.muscles.size(), muscles);
  ASSERT_EQ(reference.poses.size(), 34u);
  for (const ModelMuscle& muscle : model.muscles) {
    EXPECT_TRUE(std::all_of(muscle.wraps.begin(), muscle.wraps.end(), honoured)) << muscle.name;
    const Row truth = reference.of(muscle.name);
    const double difference = largest_difference(traced(model, muscle, reference), truth);
    EXPECT_LT(difference, 1e-6) << muscle.name;
    if (muscle.wraps.empty()) {
      --unwrapped;
      continue;
    }
    ModelMuscle bare = muscle;
    bare.wraps.clear();
    std::printf("%-12s traced %9.6f mm, straight %7.3f mm\n", muscle.name.c_str(), 1000 * difference,
                1000 * largest_difference(traced(model, bare, reference), truth));
  }
  EXPECT_EQ(unwrapped, 0);
}

TEST(MujocoReference, ArmTendonLengths) { expect_lengths("arm", "myoarm", 63, 7); }
TEST(MujocoReference, ElbowTendonLengths) { expect_lengths("elbow", "myoelbow_2dof6muscles", 6, 1); }
TEST(MujocoReference, LegTendonLengths) { expect_lengths("leg", "myolegs", 80, 44); }

// The same elbow as an OpenSim model, written with more digits: an unwrapped muscle agrees to what was rounded off.
TEST(OpenSimReference, ElbowAgreesWithItsMujocoTwin) {
  const auto path = shared_data("muscles/opensim/arm26.osim");
  if (!path) GTEST_SKIP() << kNeedsOtherWriters;
  const Model model = read_model(*path);
  ASSERT_EQ(model.muscles.size(), 6u);
  const auto muscle = std::find_if(model.muscles.begin(), model.muscles.end(),
                                   [](const ModelMuscle& one) { return one.name == "BICshort"; });
  ASSERT_NE(muscle, model.muscles.end());
  const Lengths reference = read_lengths("myoelbow_2dof6muscles");
  for (const std::string& joint : reference.joints) EXPECT_GE(model.find_coordinate(joint), 0) << joint;
  ModelMuscle bare = *muscle;
  bare.wraps.clear();
  EXPECT_LT(largest_difference(traced(model, bare, reference), reference.of("BICshort")), 3e-4);
}

}  // namespace
}  // namespace bodyopt::trainer::muscle_models
