// What went wrong, until it is clicked away, and what went well, for some seconds: the newest few.
#include <imgui.h>

#include <algorithm>

#include "proxy_viewer/panels/panels.h"

namespace bodyopt {

void draw_messages(Controls& controls, const PanelLayout& layout) {
  constexpr std::size_t kShown = 4;
  constexpr double kPassing = 6;  // seconds
  // A picture that comes late is no time to read.
  const double passed = std::min(0.3, static_cast<double>(ImGui::GetIO().DeltaTime));
  for (Message& message : controls.messages) message.shown += passed;
  std::erase_if(controls.messages, [](const Message& m) { return !m.error && m.shown > kPassing; });
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
