#include "shots/session/view_settings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "base/json_file.h"
#include "runtime/core/error.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/random_tables.h"
#include "tests/support/temporary_folder.h"
#include "viewport/state/orbit_camera.h"

namespace bodyopt::testing {
namespace {

using namespace shots;
using namespace viewport;

constexpr double kPi = std::numbers::pi;

class RandomSettings {
 public:
  explicit RandomSettings(std::uint32_t seed) : random_(seed) {}

  ViewSettings make() {
    ViewSettings s;
    s.playback = {choice<PlayMode>(3), number(0.1, 2), yes(), yes(), {}, {}};
    if (yes()) s.playback.in = static_cast<int>(random_.below(1000)) - 500;
    if (yes()) s.playback.out = 500 + static_cast<int>(random_.below(1000));
    s.camera = view();
    for (std::uint32_t k = random_.below(3); k > 0; --k) s.cameras[name()] = view();
    s.shot_camera.look_through = yes();
    s.shot_camera.of_file = name();
    for (std::uint32_t k = random_.below(3); k > 0; --k) {
      s.shot_camera.keys[integer(-1, 1)] = {view(), choice<KeyEase>(4)};
    }
    s.look = {choice<LookStyle>(6),   yes(),        yes(), yes(), yes(), yes(), yes(), number(0, 1), yes(),
              choice<SectionAxis>(3), number(0, 1), yes(), yes(), yes(), {}};
    if (yes()) s.look.level = integer(0, 15);
    s.compare = {choice<CompareWith>(8), choice<CompareLayout>(4), number(0, 1), yes(), {}, yes(), yes()};
    if (yes()) s.compare.heat_scale_mm = number(0.1, 100);
    s.pose.correction = number(0, 1);
    for (std::uint32_t k = random_.below(4); k > 0; --k) {
      s.pose.joints[name()] = {number(-180, 180), number(-180, 180), number(-180, 180)};
      s.pose.controls[name()] = number(-2, 2);
      s.pose.pins[name()] = {number(-2, 2), number(-2, 2), number(-2, 2)};
      s.pose.axes[name()] = number(-90, 90);
      s.pose.moves[name()] = {number(-2, 2), number(-2, 2), number(-2, 2)};
      s.pose.ease = choice<KeyEase>(4);
      s.pose.eases[name()] = choice<KeyEase>(4);
      s.pose.facing[name()] = {number(-180, 180), number(-180, 180), number(-180, 180)};
      s.pose.keys[integer(-1, 1)] = s.pose;
    }
    s.compare.match = static_cast<MatchView>(integer(0, 2));
    s.jiggle = {yes(), number(0, kMostJiggle)};
    s.ghosts = {integer(0, kMostGhosts), integer(0, kMostGhosts), integer(1, kLongestGhostStep), number(0, 1), yes()};
    s.cast = {integer(1, kMostCopies), integer(0, kLongestCopyDelay)};
    s.hud.on = yes();
    s.hud.legend = yes();
    for (std::uint32_t k = random_.below(3); k > 0; --k)
      s.hud.panels[kSections[random_.below(kSections.size())].name] = yes();
    return s;
  }

 private:
  bool yes() { return random_.below(2) == 1; }
  double number(double low, double high) { return random_.uniform(low, high); }
  int integer(int low, int high) {
    return low + static_cast<int>(random_.below(static_cast<std::uint32_t>(high - low + 1)));
  }
  template <typename Choice>
  Choice choice(std::uint32_t count) {
    return static_cast<Choice>(random_.below(count));
  }
  std::string name() {
    const char* const names[] = {"LeftArm", "Über \"uns\"\n", "a.b/c", "", "schema", "x"};
    return names[random_.below(6)];
  }
  OrbitView view() {
    const Vec3 target{number(-9, 9), number(-9, 9), number(-9, 9)};
    OrbitView view{target, number(0.01, 50), number(-kPi, kPi), number(-1.5, 1.5), yes(), yes()};
    if (yes()) view.roll = number(-kPi, kPi);
    if (yes()) view.vertical_angle = number(0.1, 2);
    return view;
  }

  Random random_;
};

class ViewSettingsTest : public ::testing::Test {
 protected:
  ViewSettings read(const std::string& text) const {
    write_bytes(path_, text);
    return read_view_settings(path_);
  }

  void expect_refused(const std::string& groups, const std::vector<std::string>& named) const {
    try {
      read("{\"schema\": \"bodyopt-view-1\", " + groups + "}");
      ADD_FAILURE() << "not refused: " << groups;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::file);
      for (const std::string& text : named) {
        EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what() << "\nlacks " << text;
      }
    }
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "view.json";
};

// Every value of nested objects, by its path.
void collect(const Json& json, const std::string& place, std::map<std::string, std::set<std::string>>& values) {
  for (const auto& [key, value] : json.items()) {
    values[place + "/" + key].insert(value.dump());
    if (value.is_object()) collect(value, place + "/" + key, values);
  }
}

TEST_F(ViewSettingsTest, AreReadAsWritten) {
  RandomSettings random(42);
  std::map<std::string, std::set<std::string>> values;
  for (int k = 0; k < 240; ++k) {
    const ViewSettings settings = random.make();
    write_view_settings(settings, path_);
    EXPECT_EQ(read_view_settings(path_), settings) << read_bytes(path_);
    collect(read_json(path_, "bodyopt-view-1"), "", values);
  }
  // No field was left out, here or in the file.
  for (const auto& [place, found] : values) EXPECT_TRUE(place == "/schema" || found.size() > 1) << place;
  for (const char* key :
       {"/playback/in",           "/playback/out",     "/playback/real_time",  "/camera/target",   "/cameras/x",
        "/shot_camera/keys/-1",   "/look/tet_cut",     "/look/follow",         "/look/worn",       "/look/level",
        "/compare/heat_scale_mm", "/compare/coverage", "/pose/joints/LeftArm", "/pose/controls/x", "/pose/keys/-1",
        "/jiggle/amount",         "/ghosts/opacity",   "/cast/copies",         "/hud/on",          "/hud/legend"}) {
    EXPECT_TRUE(values.contains(key)) << key;
  }
}

TEST_F(ViewSettingsTest, WhatIsLeftOutKeepsItsDefault) {
  EXPECT_EQ(read(R"({"schema": "bodyopt-view-1"})"), ViewSettings());
  ViewSettings expected;
  expected.jiggle.amount = 2;
  expected.camera.distance = 7;
  expected.cameras["face"].target = {0, 1.6, 0};
  expected.look.style = LookStyle::matcap;
  EXPECT_EQ(read(R"({"schema": "bodyopt-view-1", "jiggle": {"amount": 2}, "camera": {"distance": 7},
                     "cameras": {"face": {"target": [0, 1.6, 0]}}, "look": {"style": "matcap"}})"),
            expected);
}

TEST_F(ViewSettingsTest, CamerasStandWhereTheyStood) {
  OrbitCamera camera;
  camera.view_axis(AxisView::top);
  camera.dolly(3);
  ViewSettings settings;
  settings.camera = camera.view();
  write_view_settings(settings, path_);
  EXPECT_EQ(OrbitCamera(read_view_settings(path_).camera).view(), camera.view());
}

TEST_F(ViewSettingsTest, UnknownKeysAreNamed) {
  expect_refused(R"("lok": {})", {"view.json", "the file", "'lok'", "'look'"});
  expect_refused(R"("look": {"wires": true})", {"'look'", "'wires'", "'wire'"});
  expect_refused(R"("cameras": {"face": {"tilt": 1}})", {"'cameras' 'face'", "'roll'"});
  expect_refused(R"("playback": {"mode": "loop", "": 1})", {"'playback'", "''"});
}

TEST_F(ViewSettingsTest, WrongValuesAreNamedWithWhatWasExpected) {
  expect_refused(R"("look": {"wire": 3})", {"'wire' is 3", "true or false"});
  expect_refused(R"("look": {"style": "shiny"})",
                 {"'style' is \"shiny\"", "'clay', 'material', 'matcap', 'flat', 'normals', 'silhouette'"});
  expect_refused(R"("look": {"style": 1})", {"'style' is 1", "'clay'"});
  expect_refused(R"("look": [])", {"'look' is []", "an object"});
  expect_refused(R"("look": null)", {"'look' is null", "an object"});
  expect_refused(R"("playback": {"speed": 2.5})", {"'speed' is 2.5", "from 0.1 to 2"});
  expect_refused(R"("playback": {"speed": "fast"})", {"'speed' is \"fast\"", "a number"});
  expect_refused(R"("playback": {"in": 1.5})", {"'in' is 1.5", "whole number"});
  expect_refused(R"("playback": {"in": 1e300})", {"'in' is 1e+300", "from -1e+09 to 1e+09"});
  expect_refused(R"("playback": {"in": 9, "out": 8})", {"'in' 9", "'out' 8"});
  expect_refused(R"("camera": {"target": [1, 2]})", {"'target' is [1,2]", "three numbers"});
  expect_refused(R"("camera": {"target": [1, 2, 1e7]})", {"'target'", "from -1000000.0 to 1000000.0"});
  expect_refused(R"("camera": {"distance": 0})", {"'distance' is 0", "from 0.01"});
  expect_refused(R"("camera": {"elevation": -2})", {"'elevation' is -2"});
  expect_refused(R"("compare": {"with": "itself"})", {"'with' is \"itself\"", "'truth'"});
  expect_refused(R"("compare": {"heat_scale_mm": 0})", {"'heat_scale_mm' is 0", "from 0.01"});
  expect_refused(R"("pose": {"correction": 1.01})", {"'correction' is 1.01", "from 0 to 1"});
  expect_refused(R"("pose": {"joints": {"LeftArm": [0, 0, "x"]}})", {"'pose' 'joints'", "'LeftArm'", "three numbers"});
  expect_refused(R"("pose": {"controls": {"breath": true}})", {"'pose' 'controls'", "'breath' is true"});
  expect_refused(R"("ghosts": {"step": 0})", {"'step' is 0", "from 1 to 1000"});
  expect_refused(R"("hud": {"panels": {"look": "open"}})", {"'hud' 'panels'", "'look' is \"open\""});
  expect_refused(R"("hud": {"panels": {"camera": true}})", {"'hud.panels' has 'camera'", "nearest is 'cameras'"});
}

TEST_F(ViewSettingsTest, OtherFilesAndVersionsAreRefused) {
  const auto read_file = [](const std::filesystem::path& path) { read_view_settings(path); };
  testing::expect_refused(read_file, path_, R"({"schema": "bodyopt-view-2"})", "bodyopt-view-1");
  testing::expect_refused(read_file, path_, R"({"schema": "bodyopt-jiggle-1"})", "bodyopt-view-1");
  testing::expect_refused(read_file, path_, "{}", "bodyopt-view-1");
  testing::expect_refused(read_file, path_, "glTF", "glTF");
  EXPECT_THROW(write_view_settings({}, path_), Error);  // it stays
  EXPECT_EQ(read_bytes(path_), "glTF");
  std::filesystem::remove(path_);
  write_view_settings(RandomSettings(1).make(), path_);
  std::string text = read_bytes(path_);
  text.pop_back();  // the end of the last line is no loss
  expect_every_truncation_refused(read_file, path_, text);
  EXPECT_GT(damage_bytes(read_file, path_, text, 2000), 1000u);
}

TEST_F(ViewSettingsTest, NamesThatAreNoTextAreNotWritten) {
  write_view_settings({}, path_);
  const std::string before = read_bytes(path_);
  ViewSettings settings;
  settings.cameras["\xff"] = {};
  EXPECT_THROW(write_view_settings(settings, path_), Error);
  EXPECT_EQ(read_bytes(path_), before);
}

}  // namespace
}  // namespace bodyopt::testing
