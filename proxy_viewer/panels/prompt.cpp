// A line to type a command into, and the commands that are like what was typed.
#include <algorithm>

#include "proxy_viewer/panels.h"
#include "proxy_viewer/panels/widgets.h"

namespace bodyopt {
namespace {

constexpr float kWidth = 520;
constexpr int kMostHints = 8;

// Of the command that is typed, or of those whose names hold what is.
void draw_hints(std::string& text) {
  const std::string name = text.substr(0, text.find(' '));
  const Command* typed = find_command(name);
  int count = 0;
  for (const Command& command : commands()) {
    const bool matches = typed && text.find(' ') != std::string::npos
                             ? &command == typed
                             : std::string(command.name).find(name) != std::string::npos;
    if (!matches || ++count > kMostHints) continue;
    ImGui::PushID(command.name);
    if (ImGui::Selectable("##take", false, ImGuiSelectableFlags_DontClosePopups))
      text = std::string(command.name) + " ";
    ImGui::SameLine(14);
    ImGui::Text("%s", command.name);
    ImGui::SameLine();
    ImGui::TextDisabled("%s", command.argument);
    ImGui::SameLine(0.55f * kWidth);
    ImGui::TextDisabled("%s", command.help);
    ImGui::PopID();
  }
}

}  // namespace

void draw_prompt(Controls& controls, const PanelLayout& layout) {
  const float width = std::min(kWidth, layout.width - 16);
  ImGui::SetNextWindowPos({0.5f * layout.right(), layout.menu + 24}, ImGuiCond_Always, {0.5f, 0});
  ImGui::SetNextWindowSize({std::max(80.0f, width), 0});
  ImGui::Begin("Prompt", nullptr, kOverWindow | ImGuiWindowFlags_NoScrollbar);
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(-1);
  std::string& text = controls.typed.prompt;
  const bool entered =
      ImGui::InputTextWithHint("##command", "a command, as: frame 12", &text, ImGuiInputTextFlags_EnterReturnsTrue);
  const bool left = ImGui::IsItemDeactivated() && !entered && ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
  draw_hints(text);
  ImGui::End();
  if (entered && text.find_first_not_of(' ') != std::string::npos) attempt(controls, text);
  if (!entered && !left) return;
  controls.prompt = false;
  text.clear();
}

}  // namespace bodyopt
