// What went wrong, until it is clicked away, and what went well, for some seconds: the newest few. Beside the
// character.
#include <imgui.h>

#include <algorithm>

#include "proxy_viewer/panels/panels.h"

namespace bodyopt {

namespace {

// A picture that comes late is no time to read.
void let_good_news_pass(std::vector<Message>& messages) {
  constexpr std::size_t kShown = 4;
  constexpr double kPassing = 6;  // seconds
  const double passed = std::min(0.3, static_cast<double>(ImGui::GetIO().DeltaTime));
  for (Message& message : messages) message.shown += passed;
  std::erase_if(messages, [](const Message& m) { return !m.error && m.shown > kPassing; });
  if (messages.size() > kShown) messages.erase(messages.begin(), messages.end() - kShown);
}

// Gives the width of its text.
float place_window(const PanelLayout& layout) {
  constexpr float kMostOfSide = 0.4f;  // of its height
  if (layout.side > 0) {
    ImGui::SetNextWindowPos({layout.right(), layout.bottom()}, ImGuiCond_Always, {0, 1});
    ImGui::SetNextWindowSizeConstraints({layout.side, 0},
                                        {layout.side, std::max(1.0f, kMostOfSide * (layout.bottom() - layout.menu))});
    return layout.side - 24;
  }
  ImGui::SetNextWindowPos({12, layout.bottom() - 12}, ImGuiCond_Always, {0, 1});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {std::max(200.0f, layout.width - 24), layout.height});
  return std::max(200.0f, layout.width - 60);
}

}  // namespace

void draw_messages(Controls& controls, PanelLayout& layout) {
  let_good_news_pass(controls.messages);
  if (controls.messages.empty()) return;
  const float width = place_window(layout);
  constexpr ImGuiWindowFlags kOverlay = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                                        ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing;
  ImGui::Begin("Messages", nullptr, kOverlay);
  ImGui::PushTextWrapPos(width);
  for (const Message& message : controls.messages) {
    if (message.error) {
      ImGui::TextColored({1, 0.5f, 0.38f, 1}, "%s", message.text.c_str());
    } else {
      ImGui::TextUnformatted(message.text.c_str());
    }
  }
  ImGui::PopTextWrapPos();
  ImGui::SetScrollHereY(1);  // to the newest, where there is no room for all
  if (ImGui::IsWindowHovered() && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) controls.messages.clear();
  if (layout.side > 0) layout.messages = ImGui::GetWindowHeight();
  ImGui::End();
}

}  // namespace bodyopt
