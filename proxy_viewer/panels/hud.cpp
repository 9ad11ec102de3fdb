// Figures over the picture: how fast, what of it the stages take, on which device, how much memory, what was dropped,
// and how far from what was trained.
#include "proxy_viewer/panels.h"
#include "proxy_viewer/panels/widgets.h"

namespace bodyopt {
namespace {

void draw_time(double milliseconds, const char* what) { ImGui::TextDisabled("%7.2f ms  %s", milliseconds, what); }

void draw_coverage(const Snapshot& snapshot) {
  const ImVec4 kOutside{0.76f, 0.55f, 1, 1};
  if (snapshot.outside > 0) {
    ImGui::TextColored(kOutside, "not trained for: %s", snapshot.outside_feature.c_str());
    ImGui::TextColored(kOutside, "%.1f standard deviations beyond", static_cast<double>(snapshot.outside));
  }
  if (snapshot.expected_mm) ImGui::TextDisabled("%7.2f mm  expected error", *snapshot.expected_mm);
}

}  // namespace

void draw_hud(const Snapshot& snapshot, const Controls& controls, const Layout& layout) {
  ImGui::SetNextWindowPos({layout.right() - 12, layout.menu + 10}, ImGuiCond_Always, {1, 0});
  ImGui::SetNextWindowBgAlpha(0);
  ImGui::Begin("HUD", nullptr,
               kFixedWindow | ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_AlwaysAutoResize |
                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoScrollbar);
  ImGui::TextDisabled("%7.1f fps, %lld dropped", snapshot.shown_fps,
                      static_cast<long long>(controls.playback.dropped()));
  draw_time(snapshot.frame_ms, "picture");
  draw_time(snapshot.draw_ms, "draw");
  for (const char* stage : {"rig", "strain", "residual", "pose", "diffuse", "jiggle", "output"}) {
    const auto found = snapshot.stage_ms.find(stage);
    if (found != snapshot.stage_ms.end()) draw_time(found->second, stage);
  }
  if (snapshot.level_count > 1) ImGui::TextDisabled("level %zu of %zu", snapshot.level, snapshot.level_count - 1);
  ImGui::TextDisabled("%7.0f MiB", snapshot.memory_mib);
  ImGui::TextDisabled("%s", snapshot.device.c_str());
  draw_coverage(snapshot);
  ImGui::End();
}

}  // namespace bodyopt
