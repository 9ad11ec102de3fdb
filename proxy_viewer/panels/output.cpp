// Files that are written, and read.
#include "proxy_viewer/panels/panels.h"
#include "proxy_viewer/panels/widgets.h"

namespace bodyopt {
namespace {

// A file's name, and buttons of commands that take it.
void draw_file(Controls& controls, std::string& name, const char* hint,
               std::initializer_list<std::pair<const char*, const char*>> commands) {
  constexpr float kButton = 80;
  ImGui::PushID(hint);
  const float space = ImGui::GetStyle().ItemSpacing.x;
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - static_cast<float>(commands.size()) * (kButton + space));
  ImGui::InputTextWithHint("##name", hint, &name);
  for (const auto& [command, text] : commands) {
    ImGui::SameLine();
    ImGui::BeginDisabled(name.empty());
    if (ImGui::Button(text, {kButton, 0})) attempt(controls, std::string(command) + " " + name);
    explain(command);
    ImGui::EndDisabled();
  }
  ImGui::PopID();
}

}  // namespace

void draw_output(const Snapshot&, Controls& controls) {
  PanelState& typed = controls.typed;
  draw_file(controls, typed.screenshot, "picture.png", {{"screenshot", "Picture"}});
  draw_file(controls, typed.sequence, "frames.####.png", {{"sequence", "Sequence"}});
  draw_file(controls, typed.turntable, "turntable.####.png", {{"turntable", "Turntable"}});
  draw_file(controls, typed.session, "session.json", {{"save", "Save"}, {"open", "Open"}});
  draw_file(controls, typed.state, "view.json", {{"save-state", "Save look"}, {"load-state", "Load look"}});
  draw_file(controls, typed.clip, "motion.glb or .bvh", {{"export-clip", "Motion"}});
  draw_file(controls, typed.skin, "skin.glb, .pc2 or .usda", {{"export-skin", "Skin"}});
  draw_file(controls, typed.open, "a basis, clip or cache", {{"open", "Open"}});
}

}  // namespace bodyopt
