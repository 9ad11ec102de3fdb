// The dataset that is looked at: its frames as a map of poses, the stack of modifiers, and pairs that disagree.
#include <algorithm>
#include <cmath>

#include "draw/colours.h"
#include "runtime/core/text.h"
#include "viewport/panels/panels.h"

namespace bodyopt::viewport {
namespace {

constexpr float kDot = 3, kMapMargin = 8;
constexpr double kWidestSlide = 500;  // mm
constexpr ImU32 kMapBackground = IM_COL32(26, 26, 28, 255);

// Frames from -1 to 1 in a square of the panel's width.
struct MapFrame {
  ImVec2 corner;
  float side;
  ImVec2 at(const PoseDot& dot) const {
    const float half = 0.5f * side - kMapMargin;
    return {corner.x + 0.5f * side + half * dot.x, corner.y + 0.5f * side - half * dot.y};
  }
};

ImU32 colour_of(const PoseDot& dot) {
  return std::isfinite(dot.heat) ? opaque(draw::heat_colour(std::clamp(dot.heat, 0.0f, 1.0f))) : kQuiet;
}

// Nearest to the mouse, within reach of it; -1: none.
int dot_under_mouse(const MapFrame& frame, const std::vector<PoseDot>& dots) {
  constexpr float kReach = 10;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  float nearest = kReach * kReach;
  int found = -1;
  for (std::size_t k = 0; k < dots.size(); ++k) {
    const ImVec2 at = frame.at(dots[k]);
    const float distance = (at.x - mouse.x) * (at.x - mouse.x) + (at.y - mouse.y) * (at.y - mouse.y);
    if (distance >= nearest) continue;
    nearest = distance;
    found = static_cast<int>(k);
  }
  return found;
}

// Thousands as squares: round ones would take a software device longer than the character does.
void draw_dots(ImDrawList& list, const MapFrame& frame, const std::vector<PoseDot>& dots) {
  constexpr std::size_t kMany = 1000;
  constexpr float kHalf = 2;
  for (const PoseDot& dot : dots) {
    const ImVec2 at = frame.at(dot);
    if (dots.size() < kMany) {
      list.AddCircleFilled(at, kDot, colour_of(dot), 8);
    } else {
      list.AddRectFilled({at.x - kHalf, at.y - kHalf}, {at.x + kHalf, at.y + kHalf}, colour_of(dot));
    }
  }
}

void draw_map(const CurationRow& curation, Controls& controls) {
  const MapFrame frame{ImGui::GetCursorScreenPos(), std::max(1.0f, ImGui::GetContentRegionAvail().x)};
  const bool clicked = ImGui::InvisibleButton("##map", {frame.side, frame.side});
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(frame.corner, {frame.corner.x + frame.side, frame.corner.y + frame.side}, kMapBackground, 4);
  draw_dots(list, frame, curation.dots);
  const int shown = controls.playback.frame() - controls.playback.first();
  if (shown >= 0 && shown < static_cast<int>(curation.dots.size())) {
    list.AddCircle(frame.at(curation.dots[static_cast<std::size_t>(shown)]), 2.2f * kDot, kAccent, 16, 2);
  }
  const int under = ImGui::IsItemHovered() ? dot_under_mouse(frame, curation.dots) : -1;
  if (under < 0) return;
  const PoseDot& dot = curation.dots[static_cast<std::size_t>(under)];
  ImGui::SetTooltip("%s", dot.text.c_str());
  if (clicked) attempt(controls, "frame " + std::to_string(controls.playback.first() + under));
}

void draw_modifier(const StackRow& row, Controls& controls) {
  bool on = row.enabled;
  if (ImGui::Checkbox("##on", &on)) attempt(controls, "modifier " + row.name + (on ? " on" : " off"));
  explain("modifier");
  ImGui::SameLine();
  ImGui::AlignTextToFramePadding();
  ImGui::Text("%s", row.name.c_str());
  if (row.name != row.type) {
    ImGui::SameLine();
    ImGui::TextDisabled("%s", row.type.c_str());
  }
  double strength = row.strength;
  const bool dragged = controls.typed.dragged_strength && controls.typed.dragged_modifier == row.name;
  if (dragged) strength = *controls.typed.dragged_strength;
  if (slide("Strength", strength, 0, 1, "%.2f", find_command("strength")->help)) {
    controls.typed.dragged_modifier = row.name;
    controls.typed.dragged_strength = strength;
  }
  if (!dragged || ImGui::IsItemActive()) return;  // the stack is edited once the mouse lets go
  controls.typed.dragged_strength.reset();
  attempt(controls, "strength " + row.name + formatted(" %.3f", strength));
}

void draw_stack(const CurationRow& curation, Controls& controls) {
  if (curation.modifiers.empty()) ImGui::TextDisabled("no modifiers: the shapes as they are");
  int number = 0;
  for (const StackRow& row : curation.modifiers) {
    ImGui::PushID(number++);
    draw_modifier(row, controls);
    ImGui::PopID();
  }
  const float width = share_of_line(3);
  command_switch(controls, "raw", "Before", width);
  ImGui::SameLine();
  command_button(controls, "undo-edit", "Undo", width);
  ImGui::SameLine();
  command_button(controls, "redo-edit", "Redo", width);
}

void draw_brushes(Controls& controls) {
  command_choice(controls, "brush", "Brush");
  BrushInHand& brush = controls.brush;
  slide("Radius", brush.radius_mm, shots::kFinestBrush, kWidestSlide, "%.0f mm", find_command("brush-radius")->help,
        ImGuiSliderFlags_Logarithmic);
  slide("Strength", brush.strength, 0, 1, "%.2f", find_command("brush-strength")->help);
  double spread = brush.spread.value_or(0);
  if (slide("Spread", spread, 0, 180, brush.spread ? "%.0f\xc2\xb0" : "auto", find_command("brush-spread")->help)) {
    brush.spread = spread;
  }
  label_before("Into");
  ImGui::InputTextWithHint("##into", "a modifier's name", &brush.modifier);
  explain("brush-modifier");
  command_tick(controls, "brush-symmetry", "Both sides of the body");
}

void draw_pairs(const CurationRow& curation, Controls& controls) {
  if (curation.pairs.empty()) {
    command_button(controls, "contradictions", "Find contradictions", share_of_line(1));
    if (controls.curating.compared) ImGui::TextDisabled("none: like poses have like shapes");
    return;
  }
  for (std::size_t k = 0; k < curation.pairs.size(); ++k) {
    ImGui::PushID(static_cast<int>(k));
    if (ImGui::Selectable(curation.pairs[k].c_str(), controls.curating.pair == static_cast<int>(k))) {
      attempt(controls, "pair " + std::to_string(k + 1));
    }
    ImGui::PopID();
  }
  command_button(controls, "next-pair", "Next", share_of_line(2));
  ImGui::SameLine();
  command_button(controls, "other-of-pair", "Other", share_of_line(2));
}

}  // namespace

void draw_curate(const Snapshot& snapshot, Controls& controls) {
  if (!snapshot.curation) return;
  const CurationRow& curation = *snapshot.curation;
  label_before("Region");
  if (ImGui::BeginCombo("##region", curation.region.c_str())) {
    for (const std::string& region : controls.curating.regions) {
      if (ImGui::Selectable(region.c_str(), region == curation.region)) attempt(controls, "region " + region);
    }
    ImGui::EndCombo();
  }
  command_choice(controls, "map-colour", "Colour");
  draw_map(curation, controls);
  ImGui::TextDisabled("%s", curation.legend.c_str());
  ImGui::Separator();
  draw_brushes(controls);
  ImGui::Separator();
  draw_stack(curation, controls);
  ImGui::Separator();
  draw_pairs(curation, controls);
}

}  // namespace bodyopt::viewport
