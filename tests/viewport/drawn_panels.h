// Panels drawn without a window, of characters that are made up, and what a hand does to them.
#pragma once

#include <gtest/gtest.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <cmath>
#include <map>
#include <set>

#include "shots/session/view_settings.h"
#include "tests/support/error_kind.h"
#include "viewport/commands/commands.h"
#include "viewport/panels/panels.h"
#include "viewport/platform/gui.h"

namespace bodyopt::testing {

inline viewport::Snapshot small_character() {
  viewport::Snapshot s;
  s.cast = {{"arm", "arm.safetensors", "bend", "truth.pc2", 100, 180, 400, 123456, "full"}};
  s.joints = {{"Hips", -1, 0}, {"LeftArm", 0, 1}, {"RightArm", 0, 1}};
  s.controls = {{"flex", 0, 1}};
  s.fibres = {"biceps/1", "biceps/2"};
  s.strains = {-0.2f, 0.1f};
  s.comparisons = {"none", "ddm", "truth"};
  s.compared = "truth";
  s.errors = {{1, 2, true}, {3, 4, true}, {}};
  s.measured = 2;
  s.worst = 1;
  s.device = "a device";
  return s;
}

// 500 joints and 1,000 fibres with long names of other scripts, numbers that are none.
inline viewport::Snapshot huge_character() {
  viewport::Snapshot s;
  const std::string greek =
      "\xce\xb1\xcf\x81\xce\xb9\xcf\x83\xcf\x84\xce\xb5\xcf\x81\xcf\x8c\xcf\x82 \xcf\x8e\xce\xbc\xce\xbf\xcf\x82";
  const std::string japanese =
      "\xe5\xb7\xa6\xe8\x85\x95%s##\xe3\x83\xbb\xe4\xb8\x8a\xe8\x85\x95\xe4\xba\x8c\xe9\xa0\xad\xe7\xad\x8b";
  for (int c = 0; c < 20; ++c) {
    s.cast.push_back({japanese, greek, greek, greek, 4000000000u, 4000000000u, 98456, 1ull << 40, "jiggle"});
  }
  for (int j = 0; j < 500; ++j) s.joints.push_back({j % 3 == 0 ? greek : japanese, j - 1, j});
  for (int c = 0; c < 60; ++c) s.controls.push_back({greek, 0, 1});
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (int f = 0; f < 1000; ++f) {
    s.fibres.push_back(japanese);
    s.strains.push_back(f == 7 ? inf : static_cast<float>(f % 200) / 100 - 1);
  }
  s.errors.assign(20000, {1e9f, inf, true});
  s.errors[3] = {nan, nan, true};
  s.errors[4] = {};
  s.measured = 19999;
  s.worst = 0;
  s.outside = 12;
  s.outside_feature = greek;
  s.expected_mm = 1e6;
  s.level_count = 9;
  s.compared = greek;
  s.device = japanese;
  return s;
}

// As a dataset of three frames is looked at.
inline viewport::CurationRow small_dataset() {
  viewport::CurationRow row;
  row.region = "forearm";
  row.dots = {{-1, 0, 0, "rom 1"}, {0, 1, 0.5f, "rom 2"}, {1, -1, NAN, "rom 3"}};
  row.legend = "hottest: 3.00 mm";
  row.modifiers = {{"elbow", "sculpt", true, 0.5}, {"smooth", "smooth", false, 1}};
  row.pairs = {"3.00 mm  rom 1 - rom 3  forearm"};
  return row;
}

// As two bodies match.
inline viewport::MatchRow small_match() {
  viewport::MatchRow row{false, 0.9, 1.1, {{"LeftArm", 0.6, 2.3, 0.4, true}, {"Hips", 0.95, 1, 0.1, false}}};
  row.volumes = {1.013, 0.994};
  row.to_simulate = "3, 12-14";
  return row;
}

// Without muscles, clip, controls or errors.
inline viewport::Snapshot bare_character() {
  viewport::Snapshot s;
  s.joints = {{"root"}};
  return s;
}

inline viewport::Controls controls_with_all_open(const viewport::Snapshot& snapshot) {
  viewport::Controls controls;
  const int count = static_cast<int>(std::max<std::size_t>(3, snapshot.errors.size()));
  controls.playback = viewport::Playback({1, count}, 24);
  controls.playback.set_keys({2});
  for (const viewport::JointRow& row : snapshot.joints) controls.joint_names.push_back(row.name);
  controls.joint = snapshot.joints.back().name;
  for (const shots::Section& section : shots::kSections) controls.settings.hud.panels[section.name] = true;
  controls.settings.look.tets = controls.settings.compare.heat = true;
  controls.settings.compare.with = shots::CompareWith::truth;
  controls.settings.cameras["close"] = {};
  controls.prompt = controls.cheat_sheet = true;
  controls.dialog = viewport::FileDialog{"open", "/", "a.glb", {{"..", true}, {"a.glb", false}}};
  controls.messages.push_back(
      {.error = true, .text = "a long text that names a file, what was expected and what was found instead of it"});
  return controls;
}

class PanelsTest : public ::testing::Test {
 protected:
  // One picture of the panels, as the application makes them.
  draw::Rectangle draw(const viewport::Snapshot& snapshot, viewport::Controls& controls, std::uint32_t width = 1280,
                       std::uint32_t height = 720) {
    viewport::visit_texts(snapshot, controls, [this](const std::string& text) { gui_.fonts().show(text); });
    gui_.begin(width, height, 1.0 / 60);
    const draw::Rectangle area = viewport::draw_panels(snapshot, controls, width, height).area;
    gui_.end();
    return area;
  }

  static int vertices() { return ImGui::GetDrawData()->TotalVtxCount; }

  static ImRect rectangle_of(const char* window) { return ImGui::FindWindowByName(window)->Rect(); }

  // The mouse goes there, presses, and lets go, each in a picture of its own.
  void click(const viewport::Snapshot& snapshot, viewport::Controls& controls, ImVec2 at) {
    ImGuiIO& io = ImGui::GetIO();
    io.MousePos = at;
    for (const bool down : {false, true, false}) {
      io.MouseDown[0] = down;
      draw(snapshot, controls);
    }
  }

  // A key goes down and up again, each in a picture of its own.
  void press(const viewport::Snapshot& snapshot, viewport::Controls& controls, ImGuiKey key) {
    ImGuiIO& io = ImGui::GetIO();
    io.KeyMap[key] = key;  // any number will do
    for (const bool down : {true, false}) {
      io.KeysDown[key] = down;
      draw(snapshot, controls);
    }
  }

  viewport::Gui gui_;
};

}  // namespace bodyopt::testing
