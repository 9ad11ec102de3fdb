// Panels of the lead's modifiers, in their order, with a switch, the strength, and the controls of each; and of jiggle.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "runtime/core/text.h"
#include "viewport/panels/panels.h"
#include "viewport/state/strain_colour.h"

namespace bodyopt::viewport {
namespace {

double value_of(const ControlRow& row, const Controls& controls) {
  return shots::set_or(controls.settings.pose.controls, row.name, row.usual);
}

// Returns the name within its modifier, whose name is above it.
std::string own_name(const ControlRow& row) {
  return row.name == row.modifier ? "strength" : row.name.substr(row.modifier.size() + 1);
}

void draw_row(const ControlRow& row, Controls& controls) {
  double value = value_of(row, controls);
  if (slide(own_name(row).c_str(), value, row.low, row.high, "%.2f", row.what.c_str())) {
    controls.settings.pose.controls[row.name] = value;
  }
}

void draw_switch(const ControlRow& strength, const std::string& type, Controls& controls) {
  bool on = value_of(strength, controls) > 0;
  if (!ImGui::Checkbox((strength.name + "##on").c_str(), &on)) {
    ImGui::SameLine();
    ImGui::TextDisabled("%s", type.c_str());
    return;
  }
  controls.settings.pose.controls[strength.name] = on ? std::max(strength.usual, 1.0) : 0.0;
}

// The strain of every muscle fibre, in the colours that fibres have. The most strained are at the top, in the order in
// which they were when it began to play.

constexpr float kMuscleRow = 18, kMostMuscleRows = 12;

void draw_row(const std::string& name, float strain) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, middle = at.x + 0.78f * width;
  const float half = 0.21f * width;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float end = middle + half * std::clamp(strain / kFullStrain, -1.0f, 1.0f);
  list.AddRectFilled({middle - half, at.y + 3}, {middle + half, at.y + kMuscleRow - 3},
                     ImGui::GetColorU32(ImGuiCol_FrameBg));
  list.AddRectFilled({std::min(middle, end), at.y + 3}, {std::max(middle, end), at.y + kMuscleRow - 3},
                     strain_colour(strain));
  list.PushClipRect(at, {middle - half - 48, at.y + kMuscleRow}, true);
  list.AddText({at.x, at.y + 1}, ImGui::GetColorU32(ImGuiCol_Text), name.c_str());
  list.PopClipRect();
  const std::string percent = formatted("%+.0f %%", 100 * static_cast<double>(strain));
  const float text = ImGui::CalcTextSize(percent.c_str()).x;
  list.AddText({middle - half - 6 - text, at.y + 1}, kQuiet, percent.c_str());
  ImGui::Dummy({width, kMuscleRow});
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s: %+.1f %%", name.c_str(), 100 * static_cast<double>(strain));
}

std::vector<std::size_t> by_strain(const std::vector<float>& strains, std::size_t count) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t f) { return std::abs(strains[f]); });
  return order;
}

}  // namespace

void draw_modifiers(const Snapshot& snapshot, Controls& controls) {
  if (snapshot.modifiers.empty()) ImGui::TextDisabled("none: 'bodyopt modifiers' gives a basis some");
  for (const ModifierRow& modifier : snapshot.modifiers) {
    ImGui::PushID(modifier.name.c_str());
    for (const ControlRow& row : snapshot.controls) {
      if (row.modifier != modifier.name) continue;
      if (row.name == modifier.name) draw_switch(row, modifier.type, controls);
      draw_row(row, controls);
    }
    ImGui::PopID();
  }
}

// Flesh that moves by inertia.
void draw_jiggle(const Snapshot& snapshot, Controls& controls) {
  if (snapshot.cast.empty() || snapshot.cast.front().tets == 0) {
    ImGui::PushTextWrapPos();
    ImGui::TextDisabled("%s", shots::set_or(controls.missing, "jiggle on", "no dynamics").c_str());
    ImGui::PopTextWrapPos();
    return;
  }
  command_tick(controls, "jiggle", "On");
  ImGui::SameLine();
  command_button(controls, "reset-jiggle", "Begin anew");
  ImGui::BeginDisabled(!controls.settings.jiggle.on);
  slide("Amount", controls.settings.jiggle.amount, 0, shots::kMostJiggle, "%.2f x",
        find_command("jiggle-amount")->help);
  ImGui::EndDisabled();
}

void draw_muscles(const Snapshot& snapshot, Controls& controls) {
  const std::size_t count = std::min(snapshot.fibres.size(), snapshot.strains.size());
  if (count == 0) {
    ImGui::TextDisabled("it was trained without muscles");
    return;
  }
  command_tick(controls, "fibres", "Fibres in the picture");
  std::vector<std::size_t>& order = controls.typed.fibre_order;
  if (order.size() != count || !controls.playback.playing()) order = by_strain(snapshot.strains, count);
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, 0});
  ImGui::BeginChild("strains", {0, kMuscleRow * std::min(kMostMuscleRows, static_cast<float>(count))});
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(count), kMuscleRow);
  while (clipper.Step()) {
    for (int k = clipper.DisplayStart; k < clipper.DisplayEnd; ++k) {
      const std::size_t fibre = order[static_cast<std::size_t>(k)];
      draw_row(snapshot.fibres[fibre], snapshot.strains[fibre]);
    }
  }
  ImGui::EndChild();
  ImGui::PopStyleVar();
}

}  // namespace bodyopt::viewport
