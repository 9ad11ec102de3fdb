// The panel of the comparison: what with, how both are shown, and how far they are apart.
#include <algorithm>
#include <cmath>

#include "runtime/core/text.h"
#include "viewport/panels/panels.h"

namespace bodyopt::viewport {
namespace {

void draw_error(const char* what, float millimetres) {
  const std::string text = formatted("%.2f mm", static_cast<double>(millimetres));
  ImGui::TextDisabled("%s", what);
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - ImGui::CalcTextSize(text.c_str()).x);
  ImGui::TextUnformatted(text.c_str());
}

void draw_errors(const Snapshot& snapshot, Controls& controls) {
  const auto index = static_cast<std::size_t>(controls.playback.frame() - snapshot.first_frame);
  if (index < snapshot.errors.size() && std::isfinite(snapshot.errors[index].rms)) {
    draw_error("RMS of this frame", snapshot.errors[index].rms);
    draw_error("Largest", snapshot.errors[index].max);
  }
  const bool jiggles = snapshot.compared == "jiggle" || (!snapshot.cast.empty() && snapshot.cast[0].method == "jiggle");
  if (jiggles) ImGui::TextDisabled("without jiggle, which has a past");
  const float width = share_of_line(2);
  command_button(controls, "worst-frame", nullptr, width);
  ImGui::SameLine();
  command_button(controls, "worst-vertex", nullptr, width);
  if (snapshot.measured < snapshot.errors.size()) {
    ImGui::TextDisabled("%zu of %zu frames measured", snapshot.measured, snapshot.errors.size());
  }
}

void draw_heat_scale(Controls& controls) {
  std::optional<double>& set = controls.settings.compare.heat_scale_mm;
  double mm = controls.heat_mm();
  const char* const format = set ? "%.3g mm" : "auto: %.3g mm";
  if (slide("Hottest", mm, shots::kFinestHeat, shots::kCoarsestHeat, format, find_command("heat-scale")->help,
            ImGuiSliderFlags_Logarithmic)) {
    set = mm;
  }
  if (set && ImGui::Button("Hottest by what was measured")) attempt(controls, "heat-scale auto");
}

// Texts over the picture, of what is compared with what, and the line of a wipe, to be dragged.

constexpr float kNamesTop = 12, kNamePadding = 3;  // points

void draw_name(const std::string& name, float middle, float low, float high, float top) {
  const ImVec2 size = ImGui::CalcTextSize(name.c_str());
  if (high - low < size.x + 24) return;
  const float x = std::clamp(middle - 0.5f * size.x, low + 12, high - size.x - 12);
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.AddRectFilled({x - 8, top - kNamePadding}, {x + size.x + 8, top + size.y + kNamePadding},
                     IM_COL32(20, 20, 22, 170), 4);
  list.AddText({x, top}, IM_COL32(225, 225, 228, 255), name.c_str());
}

void draw_wipe(Controls& controls, const PanelLayout& layout) {
  constexpr float kGrip = 5;  // pixels to either side
  double& wipe = controls.settings.compare.wipe;
  const float x = static_cast<float>(wipe) * layout.right();
  const ImVec2 top{x, layout.menu}, bottom{x, layout.bottom()};
  ImGui::SetNextWindowPos({x - kGrip, layout.menu});
  ImGui::SetNextWindowSize({2 * kGrip, std::max(1.0f, layout.bottom() - layout.menu)});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
  ImGui::Begin("Wipe", nullptr, kFixedWindow | ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoScrollbar);
  ImGui::InvisibleButton("line", ImGui::GetWindowSize());
  const bool held = ImGui::IsItemActive(), hovered = ImGui::IsItemHovered();
  if (held) wipe = std::clamp(static_cast<double>(ImGui::GetIO().MousePos.x / layout.right()), 0.0, 1.0);
  if (held || hovered) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
  ImGui::End();
  ImGui::PopStyleVar(2);
  ImGui::GetBackgroundDrawList()->AddLine(top, bottom, held || hovered ? kAccent : IM_COL32(225, 225, 228, 150), 1.5f);
}

}  // namespace

void draw_compare(const Snapshot& snapshot, Controls& controls) {
  shots::ViewSettings::Compare& compare = controls.settings.compare;
  command_choice(controls, "compare", "With", &snapshot.comparisons);
  const bool compares = !snapshot.compared.empty() && !compare.activation;
  ImGui::BeginDisabled(!compares);
  command_choice(controls, "layout", "Layout");
  ImGui::EndDisabled();
  if (compares && compare.layout == shots::CompareLayout::wipe) {
    slide("Wipe", compare.wipe, 0, 1, "%.2f", "where, of the picture's width; or drag the line in the picture");
  }
  if (compares && compare.layout == shots::CompareLayout::hold) ImGui::TextDisabled("hold X to see the other");
  command_tick(controls, "heat", "Heat of the distance");
  command_tick(controls, "activation", "Heat of what was learned");
  ImGui::BeginDisabled(!snapshot.knows_coverage);
  command_tick(controls, "coverage", "Heat of expected error");
  ImGui::EndDisabled();
  if (compare.heat || compare.activation || compare.coverage) draw_heat_scale(controls);
  if (!snapshot.compared.empty()) draw_errors(snapshot, controls);
}

bool shows_two_views(const Snapshot& snapshot, const Controls& controls) {
  return controls.settings.compare.layout == shots::CompareLayout::side_by_side && names_height(snapshot, controls) > 0;
}

float names_height(const Snapshot& snapshot, const Controls& controls) {
  const bool compares = !snapshot.compared.empty() && !controls.settings.compare.activation && !snapshot.cast.empty();
  return compares ? kNamesTop + ImGui::GetFontSize() + 2 * kNamePadding : 0;
}

void draw_comparison(const Snapshot& snapshot, Controls& controls, const PanelLayout& layout) {
  const shots::ViewSettings::Compare& compare = controls.settings.compare;
  if (!controls.settings.hud.legend || names_height(snapshot, controls) == 0) return;
  if (compare.layout == shots::CompareLayout::wipe) draw_wipe(controls, layout);
  if (layout.overlaid.top == 0) return;
  const std::string& shown = snapshot.cast.front().method;
  const float right = layout.right(), top = layout.menu + kNamesTop;
  const auto wipe = static_cast<float>(compare.wipe) * right;
  switch (compare.layout) {
    case shots::CompareLayout::side_by_side:
      draw_name(shown, 0.25f * right, 0, 0.5f * right, top);
      draw_name(snapshot.compared, 0.75f * right, 0.5f * right, right, top);
      break;
    case shots::CompareLayout::wipe:
      draw_name(shown, 0.5f * wipe, 0, wipe, top);
      draw_name(snapshot.compared, 0.5f * (wipe + right), wipe, right, top);
      break;
    case shots::CompareLayout::overlay:
      draw_name(shown + " under " + snapshot.compared, 0.5f * right, 0, right, top);
      break;
    case shots::CompareLayout::hold: {
      const std::string& seen = controls.shows_compared() ? snapshot.compared : shown;
      const std::string& other = controls.shows_compared() ? shown : snapshot.compared;
      draw_name(controls.flipped ? seen : seen + "  (hold X: " + other + ")", 0.5f * right, 0, right, top);
      break;
    }
  }
}

}  // namespace bodyopt::viewport
