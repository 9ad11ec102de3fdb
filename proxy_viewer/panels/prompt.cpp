// A line to type a command into, and the commands that are like what was typed.
#include <imgui_internal.h>

#include <algorithm>
#include <utility>

#include "proxy_viewer/panels/panels.h"
#include "proxy_viewer/panels/widgets.h"

namespace bodyopt {
namespace {

constexpr float kPromptWidth = 520;
constexpr int kMostHints = 8;

// What was typed before the field hears: it does so from the picture after it was asked to.
void take_early_letters(std::string& text) {
  for (const ImWchar letter : ImGui::GetIO().InputQueueCharacters) {
    char utf8[5];
    text += ImTextCharToUtf8(utf8, letter);
  }
  ImGui::GetIO().InputQueueCharacters.clear();
}

// A field that is entered by the keyboard has all its text selected, which the next letter would replace.
int leave_nothing_selected(ImGuiInputTextCallbackData* data) {
  bool& hears = *static_cast<bool*>(data->UserData);
  if (!hears) data->CursorPos = data->SelectionStart = data->SelectionEnd = data->BufTextLen;
  hears = true;
  return 0;
}

// At once: what is typed next is for keys again, not for a field that is gone.
void stop_typing() {
  ImGui::ClearActiveID();
  ImGui::GetIO().WantTextInput = false;
  ImGui::GetCurrentContext()->WantTextInputNextFrame = 0;
}

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
    ImGui::SameLine(0.55f * kPromptWidth);
    ImGui::TextDisabled("%s", command.help);
    ImGui::PopID();
  }
}

}  // namespace

void draw_prompt(Controls& controls, const PanelLayout& layout) {
  const float width = std::min(kPromptWidth, layout.width - 16);
  ImGui::SetNextWindowPos({0.5f * layout.right(), layout.menu + 24}, ImGuiCond_Always, {0.5f, 0});
  ImGui::SetNextWindowSize({std::max(80.0f, width), 0});
  ImGui::Begin("Prompt", nullptr, kOverWindow | ImGuiWindowFlags_NoScrollbar);
  const bool is_chosen_from = ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup);  // which the focus would close
  if (!is_chosen_from && !ImGui::IsAnyItemActive()) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(-1);
  std::string& text = controls.typed.prompt;
  bool hears = ImGui::GetActiveID() == ImGui::GetID("##command");
  if (!hears) take_early_letters(text);
  const bool enters = ImGui::InputTextWithHint(
      "##command", "a command, as: frame 12", &text,
      ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_CallbackAlways, leave_nothing_selected, &hears);
  const bool entered = std::exchange(controls.typed.entered, false) || enters;
  const bool left = ImGui::IsItemDeactivated() && !entered && ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
  draw_hints(text);
  ImGui::End();
  if (entered && text.find_first_not_of(' ') != std::string::npos) attempt(controls, text);
  if (!entered && !left) return;
  controls.prompt = false;
  text.clear();
  stop_typing();
}

}  // namespace bodyopt
