// With what the character is compared, how both are shown, and how far they are apart.
#include <cmath>

#include "proxy_viewer/panels/panels.h"
#include "proxy_viewer/panels/widgets.h"
#include "runtime/core/formatted.h"

namespace bodyopt {
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
  if (slide("Hottest", mm, kFinestHeat, kCoarsestHeat, format, find_command("heat-scale")->help,
            ImGuiSliderFlags_Logarithmic)) {
    set = mm;
  }
  if (set && ImGui::Button("Hottest by what was measured")) attempt(controls, "heat-scale auto");
}

}  // namespace

void draw_compare(const Snapshot& snapshot, Controls& controls) {
  ViewSettings::Compare& compare = controls.settings.compare;
  command_choice(controls, "compare", "With", &snapshot.comparisons);
  const bool compares = !snapshot.compared.empty() && !compare.activation;
  ImGui::BeginDisabled(!compares);
  command_choice(controls, "layout", "Layout");
  ImGui::EndDisabled();
  if (compares && compare.layout == CompareLayout::wipe) {
    slide("Wipe", compare.wipe, 0, 1, "%.2f", "where, of the picture's width; or drag the line in the picture");
  }
  if (compares && compare.layout == CompareLayout::hold) ImGui::TextDisabled("hold X to see the other");
  command_tick(controls, "heat", "Heat of the distance");
  command_tick(controls, "activation", "Heat of what was learned");
  ImGui::BeginDisabled(!snapshot.knows_coverage);
  command_tick(controls, "coverage", "Heat of expected error");
  ImGui::EndDisabled();
  if (compare.heat || compare.activation || compare.coverage) draw_heat_scale(controls);
  if (!snapshot.compared.empty()) draw_errors(snapshot, controls);
}

}  // namespace bodyopt
