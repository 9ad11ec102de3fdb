// What went wrong, or well: the newest few, until they are clicked away.
#include <imgui.h>

#include <algorithm>

#include "proxy_viewer/panels.h"

namespace bodyopt {

void draw_messages(Controls& controls, const PanelLayout& layout) {
  constexpr std::size_t kShown = 4;
  if (controls.messages.empty()) return;
  if (controls.messages.size() > kShown) {
    controls.messages.erase(controls.messages.begin(), controls.messages.end() - kShown);
  }
  ImGui::SetNextWindowPos({12, layout.height - layout.timeline - 12}, ImGuiCond_Always, {0, 1});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {std::max(200.0f, layout.width - layout.side - 24), layout.height});
  constexpr ImGuiWindowFlags kOverlay = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                                        ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing;
  ImGui::Begin("Messages", nullptr, kOverlay);
  ImGui::PushTextWrapPos(std::max(200.0f, layout.width - layout.side - 60));
  for (const Message& message : controls.messages) {
    if (message.error) {
      ImGui::TextColored({1, 0.5f, 0.38f, 1}, "%s", message.text.c_str());
    } else {
      ImGui::TextUnformatted(message.text.c_str());
    }
  }
  ImGui::PopTextWrapPos();
  if (ImGui::IsWindowHovered() && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) controls.messages.clear();
  ImGui::End();
}

}  // namespace bodyopt
