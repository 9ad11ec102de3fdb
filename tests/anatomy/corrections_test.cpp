// anatomy.json: read strictly, and what is wrong with one said with its place.
#include <gtest/gtest.h>

#include <fstream>

#include "runtime/core/error.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/temporary_folder.h"
#include "trainer/anatomy/body_kind.h"

namespace {

using namespace bodyopt;
using namespace bodyopt::trainer;

class Corrections : public ::testing::Test {
 protected:
  AnatomyCorrections read(const std::string& rest) const {
    const auto path = folder_.path() / "anatomy.json";
    std::ofstream(path) << R"({"schema": "bodyopt-anatomy-corrections-1")" << rest << "}";
    return read_corrections(path, limb_skeleton());
  }
  std::string complaint(const std::string& rest) const {
    try {
      read(rest);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  TemporaryFolder folder_;
};

TEST_F(Corrections, AreReadWhole) {
  const AnatomyCorrections read_ = read(R"(, "kind": "fish", "body_fat": 0.1,
    "bones": [{"joint": "joint1", "carries": false}, {"joint": "joint2", "thicker": 0.002}],
    "fat": [{"region": "trunk", "factor": 1.5}, {"joint": "joint0", "factor": 0.5}],
    "muscles": [{"muscle": "biceps", "volume": 150}, {"muscle": "triceps", "factor": 1.2}])");
  EXPECT_EQ(read_.kind, BodyKind::fish);
  EXPECT_EQ(read_.body_fat, 0.1);
  EXPECT_EQ(read_.of_bone("joint1").carries, false);
  EXPECT_EQ(read_.of_bone("joint2").thicker, 0.002);
  EXPECT_FALSE(read_.of_bone("joint0").carries.has_value());
  EXPECT_EQ(read_.region_fat.at("trunk"), 1.5);
  EXPECT_EQ(read_.joint_fat.at("joint0"), 0.5);
  EXPECT_NEAR(read_.muscles.at("biceps").volume, 150e-6, 1e-12);
  EXPECT_EQ(read_.muscles.at("triceps").factor, 1.2);
}

TEST_F(Corrections, SayWhatIsWrong) {
  EXPECT_NE(complaint(R"(, "kind": "horse")").find("quadruped"), std::string::npos);
  EXPECT_NE(complaint(R"(, "bones": [{"joint": "knee"}])").find("'knee'"), std::string::npos);
  EXPECT_NE(complaint(R"(, "fat": [{"region": "bum", "factor": 2}])").find("hip"), std::string::npos);
  EXPECT_NE(complaint(R"(, "fat": [{"factor": 2}])").find("fat[0]"), std::string::npos);
  EXPECT_NE(complaint(R"(, "muscles": [{"muscle": "biceps"}])").find("volume"), std::string::npos);
  EXPECT_NE(complaint(R"(, "body_fat": 15)").find("body_fat"), std::string::npos);
  EXPECT_NE(complaint(R"(, "bone": [])").find("bone"), std::string::npos);
}

}  // namespace
