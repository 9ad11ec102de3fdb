// What keys set of the selected joints, over time; of the controls while no joint is selected.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "runtime/core/text.h"
#include "shots/session/posed_clip.h"
#include "viewport/commands/flipped_pose.h"
#include "viewport/panels/panels.h"

namespace bodyopt::viewport {
namespace {

using Key = shots::ViewSettings::PoseKey;
using Keys = std::map<int, Key>;

constexpr ImU32 kColours[] = {IM_COL32(225, 90, 80, 255),  IM_COL32(120, 200, 90, 255),  IM_COL32(90, 150, 235, 255),
                              IM_COL32(225, 190, 70, 255), IM_COL32(190, 120, 225, 255), IM_COL32(80, 205, 205, 255)};
constexpr float kPoint = 5, kMargin = 8;  // points: half of what takes the mouse; over and under the values

// A number of the keys.
struct Curve {
  enum class Of { joint, axis, control } of = Of::joint;
  std::string name{};
  std::size_t turn = 0;  // of a joint: about x, y, z
  ImU32 colour = 0;

  double& in(Key& key) const {
    if (of == Of::joint) return key.joints[name][turn];
    return of == Of::axis ? key.axes[name] : key.controls[name];
  }
  // A joint that a key leaves out is as the clip has it. A control is as the keys around have it.
  bool is_in(const Key& key) const { return of != Of::control || key.controls.contains(name); }
  std::string label() const { return of == Of::joint ? name + " " + "xyz"[turn] : name; }
};

// Keeps what the curves are of, so that the keys are quickly interpolated.
Keys only(const std::vector<Curve>& curves, const Keys& keys) {
  Keys some;
  for (auto [frame, key] : keys) {
    Key& of_curves = some[frame];
    of_curves.ease = key.ease;
    of_curves.eases = key.eases;
    for (const Curve& curve : curves) {
      if (curve.is_in(key)) curve.in(of_curves) = curve.in(key);
    }
  }
  return some;
}

std::vector<Curve> curves_of(const Controls& controls) {
  std::vector<Curve> curves;
  std::set<std::string> keyed;
  for (const auto& [frame, key] : controls.settings.pose.keys) {
    for (const auto& [name, turn] : key.joints) keyed.insert(name);
    for (const auto& [name, angle] : key.axes) keyed.insert(name);
    if (!controls.joint.empty()) continue;
    for (const auto& [name, value] : key.controls) {
      const bool is_new = std::ranges::find(curves, name, &Curve::name) == curves.end();
      if (is_new) curves.push_back({.of = Curve::Of::control, .name = name});
    }
  }
  std::set<std::string> joints = controls.also;
  if (!controls.joint.empty()) joints.insert(controls.joint);
  for (const std::string& joint : joints) {
    for (std::size_t turn = 0; turn < 3 && keyed.contains(joint); ++turn) {
      curves.push_back({.name = joint, .turn = turn});
    }
    for (const std::string& axis : axes_turning(controls, joint)) {
      if (keyed.contains(axis)) curves.push_back({.of = Curve::Of::axis, .name = axis});
    }
  }
  for (std::size_t k = 0; k < curves.size(); ++k) curves[k].colour = kColours[k % std::size(kColours)];
  return curves;
}

// Returns the lowest and the highest value that is shown.
std::array<double, 2> scale_of(const std::vector<Curve>& curves, Keys keys, double narrowest) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (auto& [frame, key] : keys) {
    for (const Curve& curve : curves) {
      if (!curve.is_in(key)) continue;
      low = std::min(low, curve.in(key));
      high = std::max(high, curve.in(key));
    }
  }
  const double more = std::max(0.0, 0.5 * (narrowest - (high - low)));
  return {low - more, high + more};
}

// Frames go to the right, values up.
struct Plot : FrameBar {
  double low, high;

  float y(double value) const {
    return at.y + size.y - kMargin - static_cast<float>((value - low) / (high - low)) * (size.y - 2 * kMargin);
  }
  double per_point() const { return (high - low) / static_cast<double>(std::max(1.0f, size.y - 2 * kMargin)); }
};

void draw_plot(const Plot& plot, const Controls& controls) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 end{plot.at.x + plot.size.x, plot.at.y + plot.size.y};
  const ImU32 quiet = ImGui::GetColorU32(ImGuiCol_Text, 0.5f);
  list.AddRectFilled(plot.at, end, ImGui::GetColorU32(ImGuiCol_FrameBg, 0.6f));
  if (plot.low < 0 && 0 < plot.high) list.AddLine({plot.at.x, plot.y(0)}, {end.x, plot.y(0)}, kQuiet);
  for (const double value : {plot.low, plot.high}) {
    const std::string text = formatted("%.4g", value);
    list.AddText(nullptr, 12, {plot.at.x - 4 - ImGui::CalcTextSize(text.c_str()).x, plot.y(value) - 6}, quiet,
                 text.c_str());
  }
  const int shown = controls.playback.frame();
  if (!plot.shows(shown)) return;
  list.AddLine({plot.x(shown), plot.at.y}, {plot.x(shown), end.y}, quiet);
}

void draw_curve(const Curve& curve, const Keys& keys, const Plot& plot) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const int step = 1 + (plot.last - plot.first) / std::max(1, static_cast<int>(plot.size.x));
  for (int frame = plot.first; frame <= plot.last; frame += step) {
    Key key = shots::between_keys(keys, frame);
    if (curve.is_in(key)) list.PathLineTo({plot.x(frame), plot.y(curve.in(key))});
  }
  list.PathStroke(curve.colour, 0, 1.5f);
}

// A key is dragged up and down to another value, sideways to another frame; a click goes there. Gives the command for
// what the mouse did; empty: none.
std::string drag_key(const Curve& curve, int frame, const Plot& plot, Controls& controls) {
  std::optional<double>& before = controls.typed.curve_value;
  double& value = curve.in(controls.settings.pose.keys.at(frame));
  ImVec2 point{plot.x(frame), plot.y(value)};
  ImGui::SetCursorScreenPos({point.x - kPoint, point.y - kPoint});
  ImGui::InvisibleButton((curve.label() + std::to_string(frame)).c_str(), {2 * kPoint, 2 * kPoint});
  std::string command;
  if (ImGui::IsItemActivated()) before = value;
  if (before && (ImGui::IsItemActive() || ImGui::IsItemDeactivated())) {
    const ImVec2 by = ImGui::GetMouseDragDelta(0, 3);
    const bool goes_sideways = std::abs(by.x) > std::abs(by.y);
    const bool was_keyed = !controls.is_unkeyed();
    value = goes_sideways ? *before : *before - static_cast<double>(by.y) * plot.per_point();
    if (was_keyed) controls.settings.pose = shots::keyed_posing(controls.settings.pose, controls.playback.frame());
    const int to = goes_sideways ? plot.frame(point.x + by.x) : frame;
    point = {plot.x(to), plot.y(value)};
    if (ImGui::IsItemDeactivated()) {
      if (to != frame) command = "move-key " + std::to_string(frame) + " " + std::to_string(to);
      if (value == *before && to == frame) command = "frame " + std::to_string(frame);
      before.reset();
    }
  }
  if (ImGui::IsItemHovered() || ImGui::IsItemActive()) {
    ImGui::SetTooltip("%s, frame %d: %.4g\nup and down: its value; sideways: this key", curve.label().c_str(), frame,
                      value);
  }
  ImGui::GetWindowDrawList()->AddCircleFilled(point, kDiamond, curve.colour, 4);
  return command;
}

}  // namespace

void draw_curves(Controls& controls, float name_width, float width, int first, int last) {
  const std::vector<Curve> curves = curves_of(controls);
  if (curves.empty()) {
    ImGui::TextDisabled(controls.joint.empty() ? "select a joint with keys" : "no key turns this joint");
    return;
  }
  const ImVec2 at = ImGui::GetCursorScreenPos(), room = ImGui::GetContentRegionAvail();
  const Keys keys = only(curves, controls.settings.pose.keys);
  std::array<double, 2>& scale = controls.typed.curve_scale;  // stays while a key is dragged
  if (!controls.typed.curve_value) scale = scale_of(curves, keys, controls.joint.empty() ? 1 : 20);
  const FrameBar bar{{at.x + name_width, at.y}, {width - name_width, room.y}, first, last, kDiamond};
  const Plot plot{bar, scale[0], scale[1]};
  ImGui::PushClipRect(at, {at.x + name_width - 4, at.y + room.y}, true);
  for (const Curve& curve : curves) ImGui::TextColored(ImColor(curve.colour), "%s", curve.label().c_str());
  ImGui::PopClipRect();
  ImGui::PushClipRect({at.x, at.y}, {at.x + width, at.y + room.y}, true);
  draw_plot(plot, controls);
  for (const Curve& curve : curves) draw_curve(curve, keys, plot);
  // Keys are as they were until all curves are drawn.
  std::string command;
  for (const Curve& curve : curves) {
    for (const auto& [frame, key] : keys) {
      if (!plot.shows(frame) || !curve.is_in(key)) continue;
      const std::string of_key = drag_key(curve, frame, plot, controls);
      if (!of_key.empty()) command = of_key;
    }
  }
  ImGui::PopClipRect();
  if (!command.empty()) attempt(controls, command);
}

}  // namespace bodyopt::viewport
