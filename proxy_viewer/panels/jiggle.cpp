// Flesh that moves by inertia.
#include "proxy_viewer/panels/panels.h"
#include "proxy_viewer/panels/widgets.h"
#include "proxy_viewer/state/view_settings.h"

namespace bodyopt {

void draw_jiggle(const Snapshot& snapshot, Controls& controls) {
  if (snapshot.cast.empty() || snapshot.cast.front().tets == 0) {
    ImGui::PushTextWrapPos();
    const auto why = controls.missing.find("jiggle on");
    ImGui::TextDisabled("%s", why == controls.missing.end() ? "no dynamics" : why->second.c_str());
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
