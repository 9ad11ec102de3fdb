// Views along the axes, and cameras that were kept.
#include "proxy_viewer/panels/panels.h"
#include "proxy_viewer/panels/widgets.h"

namespace bodyopt {
namespace {

// Each above the one from the other side.
void draw_axis_views(Controls& controls) {
  constexpr int kInLine = 3;
  const float width = share_of_line(kInLine);
  int count = 0;
  for (const char* view : {"front", "right", "top", "back", "left", "bottom"}) {
    if (count++ % kInLine > 0) ImGui::SameLine();
    command_button(controls, view, nullptr, width);
  }
}

void draw_kept(Controls& controls) {
  std::string forgotten;
  int index = 0;
  for (const auto& [name, view] : controls.settings.cameras) {
    ImGui::PushID(index++);
    const float button = ImGui::GetFrameHeight();
    if (ImGui::Selectable("##go", false, 0, {ImGui::GetContentRegionAvail().x - button - 8, button})) {
      attempt(controls, "camera " + name);
    }
    ImGui::SameLine(ImGui::GetStyle().WindowPadding.x + 4);
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(name.c_str());
    ImGui::SameLine(ImGui::GetCursorPosX() + ImGui::GetContentRegionAvail().x - button);
    ImGui::SetCursorPosX(ImGui::GetWindowContentRegionMax().x - button);
    if (ImGui::Button("\xc3\x97", {button, button})) forgotten = name;
    explain("forget-camera");
    ImGui::PopID();
  }
  if (!forgotten.empty()) attempt(controls, "forget-camera " + forgotten);
}

// The first "camera 1", "camera 2", ... that is free.
std::string free_name(const Controls& controls) {
  for (int k = 1;; ++k) {
    const std::string name = "camera " + std::to_string(k);
    if (!controls.settings.cameras.contains(name)) return name;
  }
}

}  // namespace

void draw_cameras(const Snapshot&, Controls& controls) {
  draw_axis_views(controls);
  command_button(controls, "frame-selection", "Frame", share_of_line(3));
  ImGui::SameLine();
  command_tick(controls, "orthographic");
  ImGui::SameLine();
  command_tick(controls, "cut-away");
  draw_kept(controls);
  const std::string name = free_name(controls);
  const float button = 56;
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - button - ImGui::GetStyle().ItemSpacing.x);
  std::string& typed = controls.typed.camera;
  const bool entered = ImGui::InputTextWithHint("##name", name.c_str(), &typed, ImGuiInputTextFlags_EnterReturnsTrue);
  ImGui::SameLine();
  const bool keeps = ImGui::Button("Keep", {button, 0});
  explain("save-camera");
  if (!entered && !keeps) return;
  attempt(controls, "save-camera " + (typed.empty() ? name : typed));
  typed.clear();
}

}  // namespace bodyopt
