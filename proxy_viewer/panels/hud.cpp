// Figures over the picture: how fast, what of it the stages take, on which device, how much memory, what was dropped.
#include <imgui.h>

#include "proxy_viewer/panels.h"

namespace bodyopt {

void draw_hud(const Snapshot& snapshot, const Controls& controls, const Layout& layout) {
  ImGui::SetNextWindowPos({layout.width - layout.side - 12, layout.menu + 10}, ImGuiCond_Always, {1, 0});
  ImGui::SetNextWindowBgAlpha(0);
  constexpr ImGuiWindowFlags kOverlay = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs |
                                        ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                                        ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;
  ImGui::Begin("HUD", nullptr, kOverlay);
  ImGui::TextDisabled("%5.1f fps   %lld dropped", snapshot.shown_fps,
                      static_cast<long long>(controls.playback.dropped()));
  ImGui::TextDisabled("%6.2f ms picture", snapshot.frame_ms);
  ImGui::TextDisabled("%6.2f ms draw", snapshot.draw_ms);
  for (const char* stage : {"rig", "strain", "residual", "pose", "diffuse", "jiggle", "output"}) {
    const auto found = snapshot.stage_ms.find(stage);
    if (found != snapshot.stage_ms.end()) ImGui::TextDisabled("%6.2f ms %s", found->second, stage);
  }
  if (snapshot.level_count > 1) ImGui::TextDisabled("level %zu of %zu", snapshot.level, snapshot.level_count - 1);
  ImGui::TextDisabled("%6.0f MiB", snapshot.memory_mib);
  ImGui::TextDisabled("%s", snapshot.device.c_str());
  if (snapshot.outside > 0) {
    ImGui::TextColored({1, 0.55f, 0.3f, 1}, "not trained for this: %s", snapshot.outside_feature.c_str());
  }
  ImGui::End();
}

}  // namespace bodyopt
