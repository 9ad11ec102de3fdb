// A dope sheet: what is keyed, a line each, over the range that is played.
#include <algorithm>
#include <cmath>
#include <set>

#include "proxy_viewer/panels/panels.h"
#include "proxy_viewer/panels/widgets.h"

namespace bodyopt {
namespace {

constexpr float kNames = 0.42f;  // of the width
constexpr float kRow = 18, kDiamond = 4.5f;

// Joints, axes, controls and pins of a key.
std::set<std::string> names_of(const ViewSettings::PoseKey& key) {
  std::set<std::string> names;
  for (const auto& [name, value] : key.joints) names.insert(name);
  for (const auto& [name, value] : key.axes) names.insert(name);
  for (const auto& [name, value] : key.controls) names.insert(name);
  for (const auto& [name, value] : key.pins) names.insert("pin " + name);
  return names;
}

// Those of a line, to be dragged to other frames; a click goes there.
void draw_diamonds(const std::string& row, const std::set<int>& frames, const ImVec2& at, float width,
                   Controls& controls) {
  const Playback& playback = controls.playback;
  const double count = std::max(1, playback.out() - playback.in());
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(at, {at.x + width, at.y + kRow - 2}, ImGui::GetColorU32(ImGuiCol_FrameBg, 0.6f));
  const auto place = [&](int frame) {
    return at.x + kDiamond + static_cast<float>((frame - playback.in()) / count) * (width - 2 * kDiamond);
  };
  for (const int frame : frames) {
    if (frame < playback.in() || playback.out() < frame) continue;
    const float x = place(frame), y = at.y + kRow / 2 - 1;
    ImGui::SetCursorScreenPos({x - kDiamond, at.y});
    ImGui::PushID(frame);
    ImGui::InvisibleButton(row.c_str(), {2 * kDiamond, kRow});
    const bool held = ImGui::IsItemActive();
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("frame %d: drag to move the key", frame);
    if (ImGui::IsItemDeactivated()) {
      const double share = static_cast<double>((ImGui::GetIO().MousePos.x - at.x - kDiamond) / (width - 2 * kDiamond));
      const int to = playback.in() + static_cast<int>(std::lround(std::clamp(share, 0.0, 1.0) * count));
      attempt(controls, to == frame ? "frame " + std::to_string(frame)
                                    : "move-key " + std::to_string(frame) + " " + std::to_string(to));
    }
    ImGui::PopID();
    list.AddCircleFilled({held ? ImGui::GetIO().MousePos.x : x, y}, kDiamond, kAccent, 4);
  }
  if (playback.frame() < playback.in() || playback.out() < playback.frame()) return;
  const float head = place(playback.frame());
  list.AddLine({head, at.y}, {head, at.y + kRow - 2}, ImGui::GetColorU32(ImGuiCol_Text, 0.5f));
}

void draw_row(const std::string& name, const std::set<int>& frames, Controls& controls) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x;
  ImGui::PushClipRect(at, {at.x + kNames * width - 4, at.y + kRow}, true);
  ImGui::TextUnformatted(name.c_str());
  ImGui::PopClipRect();
  draw_diamonds(name, frames, {at.x + kNames * width, at.y}, (1 - kNames) * width, controls);
  ImGui::SetCursorScreenPos({at.x, at.y + kRow});
}

}  // namespace

void draw_keys(const Snapshot&, Controls& controls) {
  if (controls.settings.pose.keys.empty()) {
    ImGui::TextDisabled("no keys: pose a frame, then Set key below (Alt+K)");
    return;
  }
  std::map<std::string, std::set<int>> rows;
  std::set<int> all;
  for (const auto& [frame, key] : controls.settings.pose.keys) {
    all.insert(frame);
    for (const std::string& name : names_of(key)) rows[name].insert(frame);
  }
  draw_row("all", all, controls);
  for (const auto& [name, frames] : rows) draw_row(name, frames, controls);
  ImGui::Dummy({1, 1});
}

}  // namespace bodyopt
