#include "assets/characters/muscles.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "runtime/core/error.h"
#include "runtime/core/json.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace muscles_test {

using namespace testing;
Skeleton arm() {
  Skeleton skeleton;
  for (const char* name : {"shoulder", "elbow", "wrist"}) {
    Joint joint;
    joint.name = name;
    joint.parent = static_cast<int>(skeleton.size()) - 1;
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

std::vector<Muscle> small_muscles() {
  return {{"biceps", {{0, {0.1, 1.0 / 3, -0.2}}, {0, {0.2, 0.3, 1e-17}}, {1, {0.3, 0.25, 0}}}, 0.03, 5, 0.9},
          {"anconeus \"é\"", {{1, {0.3, 0.2, 0}}, {2, {0.5, 0.2, 0}}}, 0.004, 0, 0}};
}

void read(const std::filesystem::path& path) { read_muscles(path, arm()); }

TEST(MusclesFile, RoundTripIsBitExact) {
  const TemporaryFolder folder;
  const std::vector<Muscle> muscles = small_muscles();
  write_muscles(muscles, arm(), folder / "muscles.json");
  const std::vector<Muscle> loaded = read_muscles(folder / "muscles.json", arm());
  ASSERT_EQ(loaded.size(), muscles.size());
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    EXPECT_EQ(loaded[m].name, muscles[m].name);
    EXPECT_EQ(loaded[m].radius, muscles[m].radius);
    EXPECT_EQ(loaded[m].fibre_count, muscles[m].fibre_count);
    EXPECT_EQ(loaded[m].max_activation, muscles[m].max_activation);
    ASSERT_EQ(loaded[m].path.size(), muscles[m].path.size());
    for (std::size_t k = 0; k < muscles[m].path.size(); ++k) {
      EXPECT_EQ(loaded[m].path[k].joint, muscles[m].path[k].joint);
      EXPECT_EQ(loaded[m].path[k].position, muscles[m].path[k].position);
    }
  }
}

// Joints are stored by name, so the muscles survive a skeleton whose joints stand in another order.
TEST(MusclesFile, JointsAreMatchedByName) {
  const TemporaryFolder folder;
  write_muscles(small_muscles(), arm(), folder / "muscles.json");
  Skeleton other = arm();
  std::swap(other.joints[0].name, other.joints[2].name);
  const std::vector<Muscle> loaded = read_muscles(folder / "muscles.json", other);
  EXPECT_EQ(loaded[0].path[0].joint, 2u);
  EXPECT_EQ(loaded[1].path[1].joint, 0u);
}

TEST(MusclesFile, AJointThatIsNotThereIsAMismatch) {
  const TemporaryFolder folder;
  write_muscles(small_muscles(), arm(), folder / "muscles.json");
  Skeleton other = arm();
  other.joints[1].name = "knee";
  try {
    read_muscles(folder / "muscles.json", other);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mismatch);
    EXPECT_NE(std::string(error.what()).find("'elbow'"), std::string::npos) << error.what();
  }
}

TEST(MusclesFile, TruncatedAndDamagedFilesAreRefused) {
  const TemporaryFolder folder;
  write_muscles(small_muscles(), arm(), folder / "muscles.json");
  const std::string bytes = read_bytes(folder / "muscles.json");
  expect_every_truncation_refused(read, folder / "b.json", bytes, 1);
  EXPECT_GT(damage_bytes(read, folder / "b.json", bytes, 3000), 1000u);
}

TEST(MusclesFile, WrongPartsAreRefusedByName) {
  const TemporaryFolder folder;
  write_muscles(small_muscles(), arm(), folder / "muscles.json");
  const Json good = Json::parse(read_bytes(folder / "muscles.json"));
  const auto expect = [&](const std::string& named, const std::function<void(Json&)>& change) {
    Json bad = good;
    change(bad["muscles"][0]);
    expect_refused(read, folder / "b.json", bad.dump(), named);
  };
  expect("muscles[0] has the unknown key 'radios'", [](Json& m) { m["radios"] = 1; });
  expect("muscles[0] 'name' is empty", [](Json& m) { m["name"] = ""; });
  expect("muscles[1] has the name of an earlier muscle", [](Json& m) { m["name"] = "anconeus \"é\""; });
  expect("muscles[0] 'radius' is 0", [](Json& m) { m["radius"] = 0; });
  expect("muscles[0] 'radius' is 1.5", [](Json& m) { m["radius"] = 1.5; });
  expect("muscles[0] 'fibre_count' is -1", [](Json& m) { m["fibre_count"] = -1; });
  expect("muscles[0] 'fibre_count' is 1000000", [](Json& m) { m["fibre_count"] = 1'000'000; });
  expect("muscles[0] 'max_activation' is 1.1", [](Json& m) { m["max_activation"] = 1.1; });
  expect("muscles[0] 'path' is not a list", [](Json& m) { m["path"] = 1; });
  expect("muscles[0] has a path without length", [](Json& m) { m["path"] = Json::array(); });
  expect("muscles[0] has a path without length", [](Json& m) { m["path"] = {m["path"][0]}; });
  expect("muscles[0] has a path without length", [](Json& m) { m["path"] = {m["path"][0], m["path"][0]}; });
  expect("path[1] 'position' is not three", [](Json& m) { m["path"][1]["position"] = {1, 2}; });
  expect("path[1] 'position' is not three", [](Json& m) { m["path"][1]["position"] = {1, 2, nullptr}; });
  expect("path[1] 'position' is not three", [](Json& m) { m["path"][1]["position"] = {1, 2, 1e300}; });
  expect("path[1] lacks 'joint'", [](Json& m) { m["path"][1].erase("joint"); });
  expect("muscles[0] is not an object", [](Json& m) { m = 3; });
}

TEST(MusclesFile, FailedWritesLeaveNothing) {
  const TemporaryFolder folder;
  const auto write = [](const auto& path) { write_muscles(small_muscles(), arm(), path); };
  EXPECT_TRUE(refuses(write, folder / "nowhere/a.json", "no folder"));
  EXPECT_TRUE(refuses(write, folder.path(), "a folder"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace muscles_test
}  // namespace bodyopt
