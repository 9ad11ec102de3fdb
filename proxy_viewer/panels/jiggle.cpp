// Flesh that moves by inertia.
#include "proxy_viewer/panels/panels.h"
#include "proxy_viewer/panels/widgets.h"

namespace bodyopt {

void draw_jiggle(const Snapshot& snapshot, Controls& controls) {
  if (snapshot.cast.empty() || snapshot.cast.front().tets == 0) {
    ImGui::PushTextWrapPos();
    ImGui::TextDisabled("%s", set_or(controls.missing, "jiggle on", "no dynamics").c_str());
    ImGui::PopTextWrapPos();
    return;
  }
  command_tick(controls, "jiggle", "On");
  ImGui::SameLine();
  command_button(controls, "reset-jiggle", "Begin anew");
  ImGui::BeginDisabled(!controls.settings.jiggle.on);
  slide("Amount", controls.settings.jiggle.amount, 0, kMostJiggle, "%.2f x", find_command("jiggle-amount")->help);
  ImGui::EndDisabled();
}

}  // namespace bodyopt
